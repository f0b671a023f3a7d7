#include "csrbf/levelset/lattice_field.hpp"

#include "csrbf/core/error.hpp"

namespace csrbf {

template <int Dim>
LatticeField<Dim>::LatticeField(Data data) : data_(std::move(data)), kernel_(data_.kernel, Dim) {
  constexpr const char* here = "LatticeField";
  Index nodes = 1;
  for (std::size_t a = 0; a < Dim; ++a) {
    require(data_.size[a] > 0, here, "size", data_.size[a], "must be positive");
    nodes *= data_.size[a];
  }
  require(static_cast<Index>(data_.coefficients.size()) == nodes, here, "number of coefficients",
          data_.coefficients.size(), "must be that of the nodes");
  require(data_.support > 0 && std::isfinite(data_.support), here, "support", data_.support, "must be positive");
  require((data_.step.array() > 0).all() && data_.step.allFinite(), here, "step", data_.step.transpose(),
          "must be positive");
  require(kernel_.compact(), here, "kernel", data_.kernel, "must be compact");
  linear_ = data_.step.asDiagonal() * data_.to_lattice.linear();
  for (std::size_t a = 0; a < Dim; ++a)
    reach_[a] = static_cast<Index>(std::ceil(data_.support / data_.step[static_cast<Index>(a)]));
}

template <int Dim>
void LatticeField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const double sigma2 = data_.support * data_.support;
  const bool gradient = out.gradient != nullptr, hessian = out.hessian != nullptr;
  for (Index i = 0; i < x.cols(); ++i) {
    const Point<Dim> at = data_.to_lattice * Point<Dim>(x.col(i));
    double value = 0;
    Point<Dim> slope = Point<Dim>::Zero();
    Eigen::Matrix<double, Dim, Dim> bend = Eigen::Matrix<double, Dim, Dim>::Zero();
    std::array<Index, Dim> lo, hi, k;
    bool near = at.allFinite();
    for (std::size_t a = 0; a < Dim && near; ++a) {
      const double t = at[static_cast<Index>(a)], radius = data_.support / data_.step[static_cast<Index>(a)];
      near = t > -radius && t < static_cast<double>(data_.size[a]) + radius;
      if (!near) break;
      lo[a] = std::max<Index>(0, static_cast<Index>(std::ceil(t - radius)));
      hi[a] = std::min<Index>(data_.size[a] - 1, static_cast<Index>(std::floor(t + radius)));
      near = lo[a] <= hi[a];
    }
    k = lo;
    while (near) {
      // One row of nodes along x.
      Point<Dim> d;
      Index base = 0;
      for (std::size_t a = Dim; a-- > 0;) {
        d[static_cast<Index>(a)] =
            (at[static_cast<Index>(a)] - static_cast<double>(k[a])) * data_.step[static_cast<Index>(a)];
        base = base * data_.size[a] + (a > 0 ? k[a] : 0);
      }
      for (Index n = lo[0]; n <= hi[0]; ++n) {
        d[0] = (at[0] - static_cast<double>(n)) * data_.step[0];
        const double r2 = d.squaredNorm() / sigma2;
        if (r2 >= 1) continue;
        const double c = data_.coefficients[static_cast<std::size_t>(base + n)];
        if (c == 0) continue;
        const double r = std::sqrt(r2);
        value += c * kernel_.value(r);
        if (!gradient && !hessian) continue;
        const double g = c * kernel_.g(r) / sigma2;
        slope += g * d;
        if (!hessian) continue;
        bend += (c * kernel_.h(r) / (sigma2 * sigma2)) * d * d.transpose();
        bend.diagonal().array() += g;
      }
      std::size_t a = 1;
      for (; a < Dim && ++k[a] > hi[a]; ++a) k[a] = lo[a];
      near = a < Dim;
    }
    out.value[i] = value;
    if (gradient) {
      Eigen::Map<Point<Dim>> to(out.gradient + Dim * i);
      to = linear_.transpose() * slope;
    }
    if (hessian) {
      const Eigen::Matrix<double, Dim, Dim> H = linear_.transpose() * bend * linear_;
      for (Index a = 0, entry = symmetric_size<Dim> * i; a < Dim; ++a)
        for (Index b = a; b < Dim; ++b, ++entry) out.hessian[entry] = H(a, b);
    }
  }
}

template class LatticeField<2>;
template class LatticeField<3>;

}  // namespace csrbf
