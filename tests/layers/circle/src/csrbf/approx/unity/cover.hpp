#pragma once

#include "csrbf/approx/fit.hpp"
