#include "csrbf/approx/samples/missing_marks.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace csrbf {

bool is_usual_mark(double value) {
  constexpr std::array<double, 10> usual = {-99,   -999,   -9999, -99999, 9999,
                                            99999, -32768, 1e20,  1e30,   -3.4028234663852886e38};
  return std::find(usual.begin(), usual.end(), value) != usual.end();
}

std::optional<double> value_beyond_all_others(const Eigen::Ref<const Eigen::VectorXd>& values,
                                              std::optional<double> known) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double far = 3;  // ranges of the others; chosen by hand
  for (const double sign : {1.0, -1.0}) {
    double largest = -infinity, next = -infinity, smallest = infinity;
    Index count = 0;
    for (const double v : values) {
      if (known && v == *known) continue;
      const double value = sign * v;
      smallest = std::min(smallest, value);
      if (value > largest) {
        next = std::exchange(largest, value);
        count = 1;
      } else if (value == largest) {
        ++count;
      } else {
        next = std::max(next, value);
      }
    }
    if (!(next > -infinity) || !(largest - next > far * (next - smallest))) continue;
    const double value = sign * largest;
    const bool others_differ = next > smallest;
    if (others_differ && (is_usual_mark(value) || count > 1)) return value;
  }
  return std::nullopt;
}

}  // namespace csrbf
