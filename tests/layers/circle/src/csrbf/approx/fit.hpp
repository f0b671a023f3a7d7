#pragma once

#include "csrbf/approx/unity/cover.hpp"
