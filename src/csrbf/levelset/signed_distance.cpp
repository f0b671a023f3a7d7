#include "csrbf/levelset/signed_distance.hpp"

#include "csrbf/core/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace csrbf {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The lower envelope of parabolas of curvature edge^2 with apex f[i] at i; working memory for one line.
struct Envelope {
  std::vector<double> f, breaks;
  std::vector<Index> apexes;

  explicit Envelope(Index n)
      : f(static_cast<std::size_t>(n)), breaks(static_cast<std::size_t>(n) + 1), apexes(static_cast<std::size_t>(n)) {}

  // d[i stride] <- min_j edge^2 (i - j)^2 + d[j stride], i < n
  void transform(double* d, Index n, Index stride, double edge) {
    const double e2 = edge * edge;
    std::size_t top = 0;
    bool any = false;
    for (Index i = 0; i < n; ++i) {
      f[static_cast<std::size_t>(i)] = d[i * stride];
      if (f[static_cast<std::size_t>(i)] == infinity) continue;
      double cut = -infinity;
      while (any) {
        const Index j = apexes[top];
        cut = 0.5 * ((f[static_cast<std::size_t>(i)] - f[static_cast<std::size_t>(j)]) / (e2 * double(i - j)) +
                     double(i + j));
        if (cut > breaks[top]) break;
        if (top == 0) {
          any = false;
          cut = -infinity;
        } else {
          --top;
        }
      }
      if (any) ++top;
      any = true;
      apexes[top] = i;
      breaks[top] = cut;
      breaks[top + 1] = infinity;
    }
    if (!any) return;
    std::size_t k = 0;
    for (Index i = 0; i < n; ++i) {
      while (breaks[k + 1] < double(i)) ++k;
      const Index j = apexes[k];
      d[i * stride] = e2 * double((i - j) * (i - j)) + f[static_cast<std::size_t>(j)];
    }
  }
};

// Squared distances to the nearest 0 of d, whose other entries are infinite.
void squared_distances(const Grid& grid, std::vector<double>& d) {
  Index stride = 1;
  for (std::size_t a = 0; a < 3; stride *= grid.size[a], ++a) {
    const Index n = grid.size[a], lines = grid.voxels() / n;
    if (n == 1) continue;
    parallel_for(lines, std::max<Index>(1, 4096 / n), [&](Index begin, Index end) {
      Envelope envelope(n);
      for (Index line = begin; line < end; ++line)
        envelope.transform(d.data() + line % stride + line / stride * stride * n, n, stride,
                           grid.spacing[static_cast<Index>(a)]);
    });
  }
}

}  // namespace

std::vector<double> signed_distance(const Grid& grid, const unsigned char* labels) {
  const auto n = static_cast<std::size_t>(grid.voxels());
  double half = infinity, diagonal2 = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double edge = grid.spacing[static_cast<Index>(a)];
    if (grid.size[a] == 1) continue;
    half = std::min(half, 0.5 * edge);
    diagonal2 += std::pow(edge * static_cast<double>(grid.size[a]), 2);
  }
  if (half == infinity) half = 0;
  std::vector<double> distance(n), other(n);
  for (const bool inside : {true, false}) {
    for (std::size_t i = 0; i < n; ++i) other[i] = (labels[i] != 0) == inside ? infinity : 0;
    squared_distances(grid, other);
    for (std::size_t i = 0; i < n; ++i)
      if ((labels[i] != 0) == inside)
        distance[i] = (inside ? 1 : -1) * (std::sqrt(std::min(other[i], diagonal2)) - half);
  }
  return distance;
}

}  // namespace csrbf
