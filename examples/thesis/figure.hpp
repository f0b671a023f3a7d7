#pragma once

#include "csrbf/core/image.hpp"
#include "csrbf/core/types.hpp"

#include <string>
#include <vector>

namespace csrbf::thesis {

/// Numbers of one curve, table or picture: columns of equal length.
struct Table {
  std::string name;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows = {};
  std::vector<std::string> labels = {};  ///< of the rows, or none
};

/// A picture of numbers, x fastest.
struct Picture {
  std::string name;
  Index width = 0;
  Index height = 0;
  Eigen::VectorXd values = {};
};

/// A picture to look at.
struct Render {
  std::string caption;
  RgbImage image = {};
};

/// How what we measure compares with what the thesis says; `not_comparable` also where it gives no number, or one of
/// another machine, and for what it does not have.
enum class Verdict { holds, fails, not_comparable };

struct Claim {
  std::string what;
  std::string published;
  std::string ours;
  Verdict verdict;
};

/// The numbers of one figure or table of the thesis, or of an example that it leaves open.
struct Figure {
  std::string name;   ///< as in "figure-2.4"
  std::string title;  ///< of the page
  std::string text;   ///< how the numbers were made
  std::vector<Table> tables = {};
  std::vector<Picture> pictures = {};
  std::vector<Render> renders = {};
  std::vector<Claim> claims = {};
  std::string missing = {};  ///< data that are not there, and how to get them; then there is nothing else
};

inline Verdict verdict(bool holds) {
  return holds ? Verdict::holds : Verdict::fails;
}

/// A number with `digits` significant digits.
std::string number(double value, int digits = 3);

/// The least squares slope of log y over log x: the order of growth or of convergence.
double slope(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace csrbf::thesis
