#include "csrbf/spatial/convex_hull.hpp"

#include "csrbf/core/error.hpp"

#include <cstdio>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace csrbf {
namespace {

#ifdef _WIN32
constexpr const char* nowhere = "NUL";
#else
constexpr const char* nowhere = "/dev/null";
#endif

// A hull in memory owned by qhull.
class QuickHull {
 public:
  QuickHull(int dimension, Eigen::MatrixXd& points) : nowhere_(std::fopen(nowhere, "w")) {
    qh_zero(&hull_, nowhere_);
    char command[] = "qhull Pp";
    status_ =
        qh_new_qhull(&hull_, dimension, static_cast<int>(points.cols()), points.data(), 0, command, nullptr, nowhere_);
  }
  QuickHull(const QuickHull&) = delete;
  QuickHull& operator=(const QuickHull&) = delete;
  ~QuickHull() {
    qh_freeqhull(&hull_, True);
    int long_blocks = 0, long_bytes = 0;
    qh_memfreeshort(&hull_, &long_blocks, &long_bytes);
    if (nowhere_ != nullptr) std::fclose(nowhere_);
  }

  [[nodiscard]] bool failed() const { return status_ != 0; }

  [[nodiscard]] HalfSpaces facets(int dimension) {
    qhT* qh = &hull_;
    HalfSpaces result{Eigen::MatrixXd(dimension, qh->num_facets), Eigen::VectorXd(qh->num_facets)};
    Index count = 0;
    for (const facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      result.normals.col(count) = Eigen::Map<const Eigen::VectorXd>(facet->normal, dimension);
      result.offsets[count++] = -facet->offset;
    }
    return {result.normals.leftCols(count), result.offsets.head(count)};
  }

 private:
  std::FILE* nowhere_;
  qhT hull_;
  int status_;
};

}  // namespace

template <int Dim>
HalfSpaces convex_hull(const PointsRef<Dim>& points) {
  require(points.cols() > 0 && points.allFinite(), "convex_hull", "points", points.cols(),
          "at least one point is needed, and all coordinates must be finite");
  if constexpr (Dim == 1) {
    return {Eigen::RowVector2d(1, -1), Eigen::Vector2d(points.maxCoeff(), -points.minCoeff())};
  } else {
    const auto refuse = [] {
      throw InvalidInput("convex_hull: points: all are on a line or in a plane; use a distance instead of the hull");
    };
    if (points.cols() <= Dim) refuse();
    Eigen::MatrixXd copy = points;
    QuickHull hull(Dim, copy);
    if (hull.failed()) refuse();
    return hull.facets(Dim);
  }
}

template HalfSpaces convex_hull<1>(const PointsRef<1>&);
template HalfSpaces convex_hull<2>(const PointsRef<2>&);
template HalfSpaces convex_hull<3>(const PointsRef<3>&);

}  // namespace csrbf
