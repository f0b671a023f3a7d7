#pragma once

#include "csrbf/approx/function.hpp"
#include "csrbf/io/models/function_archive.hpp"

#include <gtest/gtest.h>

namespace csrbf {

/// Checks that two functions have the same bits at points: values, gradients and standard deviations.
inline void expect_same(const Function& a, const Function& b, const Eigen::MatrixXd& x) {
  const Function::Values found = a.evaluate(x, Derivatives::gradient), expected = b.evaluate(x, Derivatives::gradient);
  EXPECT_EQ(found.value, expected.value);
  EXPECT_EQ(found.gradient, expected.gradient);
  EXPECT_EQ(a.standard_deviation(x), b.standard_deviation(x));
}

/// What a file of a model holds, read again.
inline Archive written(const Function& function) {
  return parse_archive(format_archive(to_archive({function})), "model");
}

/// The same, after a check that the function read from it has the same bits at points.
inline Archive written_the_same(const Function& function, const Eigen::MatrixXd& x) {
  Archive archive = written(function);
  expect_same(function_from(archive).function, function, x);
  return archive;
}

/// An archive of the same kind without entries, for what an older model would hold.
inline Archive emptied(const Archive& archive) {
  Archive result;
  result.kind = archive.kind;
  result.source = archive.source;
  return result;
}

}  // namespace csrbf
