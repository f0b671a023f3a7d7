#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/global/kriging_variance.hpp"
#include "csrbf/approx/unity/cover.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/taylor.hpp"
#include "csrbf/surface/baselines/baselines.hpp"
#include "csrbf/surface/baselines/off_surface.hpp"

namespace csrbf::baselines {
namespace {

// Chosen by hand.
constexpr Index points_per_cell = 45;  // including offsets; larger: fewer, larger dense systems
constexpr double growth = 1.5;         // side of a support over that of its cell: the overlap
constexpr Index fewest = 60;           // least number of samples in a local spline

// Local splines on the supports of a cover, weighted by the product of (1 - t^2)^4 over the axes.
class SplinePartition final : public Field<3> {
 public:
  SplinePartition(Cover<3> cover, std::vector<std::shared_ptr<const Expansion<3>>> splines)
      : cover_(std::move(cover)), splines_(std::move(splines)) {}

  // Outside the box the function has its value at the nearest point of the box.
  void evaluate_block(const PointsRef<3>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      const Point<3> y = x.col(i).cwiseMax(cover_.box().lo).cwiseMin(cover_.box().hi);
      Taylor<3> W(0.0), S(0.0);
      for (const std::uint32_t cell : cover_.supports_over(cover_.find(y))) {
        const Taylor<3> w = weight(cell, y);
        if (w.value <= 0) continue;
        const Jet<3> jet = splines_[cell]->evaluate(y, out.derivatives());
        Taylor<3> f(jet.value[0]);
        if (out.gradient != nullptr) f.gradient = jet.gradient.col(0);
        if (out.hessian != nullptr) f.hessian = jet.hessian_matrix(0);
        W = W + w;
        S = S + w * f;
      }
      const Taylor<3> f = S / W;
      out.value[i] = f.value;
      if (out.gradient != nullptr) Eigen::Map<Point<3>>(out.gradient + 3 * i) = f.gradient;
      if (out.hessian == nullptr) continue;
      for (int a = 0, entry = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++entry) out.hessian[6 * i + entry] = f.hessian(a, b);
    }
  }

  [[nodiscard]] Box<3> bounds() const override { return cover_.box(); }

 private:
  [[nodiscard]] Taylor<3> weight(Index cell, const Point<3>& x) const {
    const Box<3>& box = cover_.cell(cell);
    const Point<3> center = box.center(), half = 0.5 * growth * box.extent();
    Taylor<3> product(1.0);
    for (int c = 0; c < 3; ++c) {
      Taylor<3> t((x[c] - center[c]) / half[c]);
      if (std::abs(t.value) >= 1) return Taylor<3>(0.0);
      t.gradient[c] = 1 / half[c];
      const Taylor<3> s = 1.0 - t * t, s2 = s * s;
      product = product * (s2 * s2);
    }
    return product;
  }

  Cover<3> cover_;
  std::vector<std::shared_ptr<const Expansion<3>>> splines_;
};

}  // namespace

MethodFit tobor(const PreparedCloud& cloud, const MethodOptions& options) {
  const Samples<3> samples = off_surface_samples(cloud, options.centers, Offsets::both);
  Cover<3> cover(samples.points, points_per_cell, growth);
  std::vector<std::shared_ptr<const Expansion<3>>> splines(cover.size());
  parallel_for(cover.size(), 8, [&](Index begin, Index end) {
    Cover<3>::Search search;
    for (Index cell = begin; cell < end; ++cell) {
      const Point<3> center = cover.cell(cell).center(), half = 0.5 * growth * cover.cell(cell).extent();
      Index count = fewest;
      std::vector<Index> ids;
      // All samples in the support: nearest ones until they reach beyond its corners.
      for (bool all = false; !all; count *= 2) {
        cover.nearest(center, count, half.norm(), search);
        all = count >= samples.size() || search.found.empty() || search.found.back().first > half.squaredNorm();
      }
      for (std::size_t k = 0; k < search.found.size(); ++k) {
        const std::uint32_t column = search.found[k].second;
        const Point<3> d = (cover.points().col(column) - center).cwiseAbs();
        if (k < static_cast<std::size_t>(fewest) || (d.array() < half.array()).all())
          ids.push_back(cover.order()[column]);
      }
      const Samples<3> local{samples.points(Eigen::all, ids), samples.values(ids, Eigen::all), {}};
      splines[cell] =
          interpolate<3>(local, {.kernel = "cubic", .smoothing = options.smoothing.value_or(0)}).components.front();
    }
  });
  const Index n = samples.size();
  return {std::make_shared<const SplinePartition>(std::move(cover), std::move(splines)), n,
          options.smoothing.value_or(0)};
}

}  // namespace csrbf::baselines
