#pragma once

#include "csrbf/core/error.hpp"

#include <string>

namespace csrbf {

/// What the InvalidInput thrown by `action` says; empty when it does not throw.
template <class Action>
std::string invalid_input_message(Action&& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace csrbf
