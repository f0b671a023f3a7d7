#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace csrbf {

/// A documented precondition does not hold. The message names function, parameter, value, constraint and remedy.
class InvalidInput : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// The input is valid but no result of the requested quality exists.
class SolverFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A file cannot be read or written; the message starts with "file:line:" where a line is known.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The progress callback asked to stop.
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("cancelled") {}
};

/// Throws InvalidInput "function: name = value: constraint" unless `holds`. Write conditions so that NaN fails them.
template <class Value>
void require(bool holds, std::string_view function, std::string_view name, const Value& value,
             std::string_view constraint) {
  if (holds) return;
  std::ostringstream message;
  message << function << ": " << name << " = " << value << ": " << constraint;
  throw InvalidInput(message.str());
}

}  // namespace csrbf
