#pragma once

#include "csrbf/surface/reconstruct.hpp"
