#pragma once

#include "csrbf/core/progress.hpp"
#include "csrbf/core/types.hpp"

#include <nlohmann/json.hpp>

#include <memory>
#include <string>
#include <vector>

namespace csrbf::wasm {

using Json = nlohmann::json;

/// What a call returns to JavaScript: a text in JSON and arrays, which stay where they are until release(). The text
/// lists the arrays under "arrays": name, type (f8, i4, u4, u1), address and count.
class Answer {
 public:
  Json json = Json::object();

  /// Adds an array that the answer keeps.
  template <class Scalar>
  void add(const std::string& name, std::vector<Scalar> values) {
    auto kept = std::make_shared<std::vector<Scalar>>(std::move(values));
    add(name, type_of<Scalar>(), kept->data(), kept->size());
    kept_.push_back(std::move(kept));
  }
  /// The same for a matrix, column by column.
  template <class Scalar, int Rows, int Cols>
  void add(const std::string& name, Eigen::Matrix<Scalar, Rows, Cols> values) {
    auto kept = std::make_shared<Eigen::Matrix<Scalar, Rows, Cols>>(std::move(values));
    add(name, type_of<Scalar>(), kept->data(), static_cast<std::size_t>(kept->size()));
    kept_.push_back(std::move(kept));
  }

  /// The JSON text; valid until the next call.
  const char* text();

 private:
  template <class Scalar>
  static const char* type_of();
  void add(const std::string& name, const char* type, const void* data, std::size_t count);

  std::vector<std::shared_ptr<const void>> kept_;
  std::string text_;
};

template <>
inline const char* Answer::type_of<double>() {
  return "f8";
}
template <>
inline const char* Answer::type_of<std::int32_t>() {
  return "i4";
}
template <>
inline const char* Answer::type_of<std::uint32_t>() {
  return "u4";
}
template <>
inline const char* Answer::type_of<std::uint8_t>() {
  return "u1";
}

/// Tells the listener of JavaScript; its answer false stops the work.
Progress progress();

/// work(answer); an exception becomes {"error": message, "name": InvalidInput, SolverFailure, IoError, Cancelled or
/// Error}. The caller owns the answer.
template <class Work>
Answer* answer(const Work& work);

/// Fills in the exception that is being handled.
void describe_exception(Json& json);

template <class Work>
Answer* answer(const Work& work) {
  auto result = std::make_unique<Answer>();
  try {
    work(*result);
  } catch (...) {
    result = std::make_unique<Answer>();
    describe_exception(result->json);
  }
  return result.release();
}

}  // namespace csrbf::wasm
