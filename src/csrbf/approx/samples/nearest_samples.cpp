#include "csrbf/approx/samples/nearest_samples.hpp"

#include "csrbf/spatial/kd_tree.hpp"
#include "csrbf/spatial/morton_order.hpp"

#include <numeric>
#include <utility>

namespace csrbf {
namespace {

using MatrixRef = Eigen::Ref<const Eigen::MatrixXd>;

template <int Dim>
class TreeSearch : public NearestSamples {
 public:
  explicit TreeSearch(const Eigen::MatrixXd& points)
      : tree_(Eigen::Map<const Points<Dim>>(points.data(), Dim, points.cols())) {}

  void nearest(const double* x, Index k, Index* indices, double* squared_distances) const override {
    tree_.nearest(Eigen::Map<const Point<Dim>>(x), k, indices, squared_distances);
  }

 private:
  KdTree<Dim> tree_;
};

class FullSearch : public NearestSamples {
 public:
  explicit FullSearch(const Eigen::MatrixXd& points) : points_(points.data(), points.rows(), points.cols()) {}

  void nearest(const double* x, Index k, Index* indices, double* /*squared_distances*/) const override {
    const Eigen::Map<const Eigen::VectorXd> at(x, points_.rows());
    std::vector<std::pair<double, Index>> candidates;
    candidates.reserve(points_.cols());
    for (Index i = 0; i < points_.cols(); ++i) candidates.emplace_back((points_.col(i) - at).squaredNorm(), i);
    std::nth_element(candidates.begin(), candidates.begin() + (k - 1), candidates.end());
    for (Index j = 0; j < k; ++j) indices[j] = candidates[j].second;
  }

 private:
  Eigen::Map<const Eigen::MatrixXd> points_;
};

}  // namespace

std::unique_ptr<const NearestSamples> nearest_samples(const Eigen::MatrixXd& points) {
  switch (points.rows()) {
#define CSRBF_CASE(Dim) \
  case Dim:             \
    return std::make_unique<const TreeSearch<Dim>>(points);
    CSRBF_FOR_EACH_DIM(CSRBF_CASE)
#undef CSRBF_CASE
    default:
      return std::make_unique<const FullSearch>(points);
  }
}

std::vector<Index> nearby_order(const MatrixRef& points) {
  switch (points.rows()) {
#define CSRBF_CASE(Dim)                                                              \
  case Dim:                                                                          \
    return morton_order<Dim>(Eigen::Map<const Points<Dim>, 0, Eigen::OuterStride<>>( \
        points.data(), Dim, points.cols(), Eigen::OuterStride<>(points.outerStride())));
    CSRBF_FOR_EACH_DIM(CSRBF_CASE)
#undef CSRBF_CASE
    default: {
      std::vector<Index> order(points.cols());
      std::iota(order.begin(), order.end(), Index{0});
      return order;
    }
  }
}

}  // namespace csrbf
