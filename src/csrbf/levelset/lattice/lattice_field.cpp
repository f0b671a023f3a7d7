#include "csrbf/levelset/lattice/lattice_field.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

namespace csrbf {

template <int Dim>
Box<Dim> image_box(const Grid& grid) {
  const auto map = grid.to_physical<Dim>();
  Box<Dim> box;
  for (int corner = 0; corner < (1 << Dim); ++corner) {
    Point<Dim> p;
    for (int a = 0; a < Dim; ++a) p[a] = (corner >> a) % 2 == 0 ? -0.5 : static_cast<double>(grid.size[a]) - 0.5;
    box.add(Point<Dim>(map * p));
  }
  return box;
}

// The nodes around a point: rows of them along x, one after the other.
template <int Dim>
struct LatticeField<Dim>::Workspace {
  struct Row {
    Index begin, end;  // in the arrays below
    Point<Dim> d;      // from its first node to the point
  };
  explicit Workspace(Index most) : r2(most), c(most), phi(most), g(most), h(most) { rows.reserve(64); }

  std::vector<Row> rows;
  Eigen::ArrayXd r2, c, phi, g, h;  // squared distance in supports, coefficient, kernel
  Index size = 0;
};

template <int Dim>
LatticeField<Dim>::LatticeField(Data data) : data_(std::move(data)), kernel_(data_.kernel, Dim) {
  constexpr const char* here = "LatticeField";
  Index nodes = 1;
  for (Index a = 0; a < Dim; ++a) {
    require(data_.size[a] > 0, here, "size", data_.size[a], "must be positive");
    require(nodes <= std::numeric_limits<Index>::max() / data_.size[a], here, "size", data_.size[a], "is too large");
    nodes *= data_.size[a];
  }
  require(std::ssize(data_.coefficients) == nodes, here, "number of coefficients", data_.coefficients.size(),
          "must be that of the nodes");
  require(data_.support > 0 && std::isfinite(data_.support), here, "support", data_.support, "must be positive");
  require((data_.step.array() > 0).all() && data_.step.allFinite(), here, "step", data_.step.transpose(),
          "must be positive");
  require(kernel_.compact(), here, "kernel", data_.kernel, "must be compact");
  linear_ = data_.step.asDiagonal() * data_.to_lattice.linear();
  for (int corner = 0; corner < (1 << Dim); ++corner) {
    Point<Dim> p;
    for (int a = 0; a < Dim; ++a) p[a] = (corner >> a) % 2 == 0 ? data_.bounds.lo[a] : data_.bounds.hi[a];
    image_.add(Point<Dim>(data_.to_lattice * p));
  }
  // The box of an image that is turned reaches beyond it.
  for (Index a = 0; a < Dim; ++a) {
    image_.lo[a] = std::max(image_.lo[a], 0.0);
    image_.hi[a] = std::min(image_.hi[a], static_cast<double>(data_.size[a] - 1));
  }
  double largest = 0;
  for (const double c : data_.coefficients) largest = std::max(largest, std::abs(c));
  depth_ = largest * static_cast<double>(most_nodes());
}

// Nodes of which any point may depend, at most.
template <int Dim>
Index LatticeField<Dim>::most_nodes() const {
  Index most = 1;
  for (Index a = 0; a < Dim; ++a) {
    const double across = 2 * data_.support / data_.step[a] + 2;
    most *= static_cast<Index>(std::min(static_cast<double>(data_.size[a]), across));
  }
  return most;
}

// Finds the nodes within the support around the point with these node coordinates.
template <int Dim>
void LatticeField<Dim>::gather(const Point<Dim>& at, Workspace& w) const {
  w.rows.clear();
  w.size = 0;
  if (!at.allFinite()) return;
  std::array<Index, Dim> lo, hi, k;
  for (Index a = 0; a < Dim; ++a) {
    const double t = at[a], radius = data_.support / data_.step[a];
    const double last = static_cast<double>(data_.size[a] - 1);
    if (!(t > -radius && t < last + radius)) return;
    lo[a] = static_cast<Index>(std::ceil(std::max(0.0, t - radius)));
    hi[a] = static_cast<Index>(std::floor(std::min(last, t + radius)));
    if (lo[a] > hi[a]) return;
  }
  const double step = data_.step[0], scale = 1 / (data_.support * data_.support);
  for (k = lo;;) {
    Point<Dim> d;
    Index base = 0;
    double beside2 = 0;  // of the whole row
    for (Index a = Dim; a-- > 1;) {
      d[a] = (at[a] - static_cast<double>(k[a])) * data_.step[a];
      beside2 += d[a] * d[a];
      base = (base + k[a]) * data_.size[a - 1];
    }
    const double along2 = data_.support * data_.support - beside2;
    if (along2 > 0) {
      const double along = std::sqrt(along2) / step;
      const auto low = static_cast<double>(lo[0]), high = static_cast<double>(hi[0]);
      const auto first = static_cast<Index>(std::ceil(std::clamp(at[0] - along, low, high + 1)));
      const auto last = static_cast<Index>(std::floor(std::clamp(at[0] + along, low - 1, high)));
      d[0] = (at[0] - static_cast<double>(first)) * step;
      const double* c = data_.coefficients.data() + base;
      const Index begin = w.size;
      double* r2 = w.r2.data() + begin - first;
      double* to = w.c.data() + begin - first;
      for (Index n = first; n <= last; ++n) {
        const double x = d[0] - static_cast<double>(n - first) * step;
        r2[n] = (beside2 + x * x) * scale;
        to[n] = c[n];
      }
      if (first <= last) {
        w.size += last - first + 1;
        w.rows.push_back({begin, w.size, d});
      }
    }
    Index a = 1;
    for (; a < Dim && ++k[a] > hi[a]; ++a) k[a] = lo[a];
    if (a == Dim) return;
  }
}

// Adds -depth r^2 / (1 + r^2) at a point with these node coordinates.
template <int Dim>
void LatticeField<Dim>::add_outside(const Point<Dim>& at, Index i, const JetBlock& out) const {
  Point<Dim> beyond = at - at.cwiseMax(image_.lo).cwiseMin(image_.hi);
  if (!at.allFinite() || beyond.isZero(0)) return;
  beyond = beyond.cwiseProduct(data_.step) / data_.support;
  const double shrink = 1 / (1 + beyond.squaredNorm());
  out.value[i] -= depth_ * (1 - shrink);
  if (!(shrink > 0)) return;
  const Eigen::Matrix<double, Dim, Dim> map = linear_ / data_.support;
  if (out.gradient != nullptr)
    Eigen::Map<Point<Dim>>(out.gradient + Dim * i) -= 2 * depth_ * shrink * shrink * (map.transpose() * beyond);
  if (out.hessian == nullptr) return;
  Eigen::Matrix<double, Dim, Dim> bend = -4 * shrink * beyond * beyond.transpose();
  for (Index a = 0; a < Dim; ++a)
    if (beyond[a] != 0) bend(a, a) += 1;
  const Eigen::Matrix<double, Dim, Dim> H = 2 * depth_ * shrink * shrink * map.transpose() * bend * map;
  for (Index a = 0, entry = symmetric_size<Dim> * i; a < Dim; ++a)
    for (Index b = a; b < Dim; ++b, ++entry) out.hessian[entry] -= H(a, b);
}

template <int Dim>
void LatticeField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  const double sigma2 = data_.support * data_.support;
  const bool gradient = out.gradient != nullptr, hessian = out.hessian != nullptr;
  Workspace w(most_nodes());
  for (Index i = 0; i < x.cols(); ++i) {
    const Point<Dim> at = data_.to_lattice * Point<Dim>(x.col(i));
    gather(at, w);
    if (hessian)
      kernel_.hessians(w.r2.data(), w.size, w.phi.data(), w.g.data(), w.h.data());
    else if (gradient)
      kernel_.gradients(w.r2.data(), w.size, w.phi.data(), w.g.data());
    else
      kernel_.values(w.r2.data(), w.size, w.phi.data());
    out.value[i] = (w.c.head(w.size) * w.phi.head(w.size)).sum();
    if (!gradient && !hessian) {
      add_outside(at, i, out);
      continue;
    }

    Point<Dim> slope = Point<Dim>::Zero();
    Eigen::Matrix<double, Dim, Dim> bend = Eigen::Matrix<double, Dim, Dim>::Zero();
    double slopes = 0;
    for (const auto& row : w.rows) {
      double g0 = 0, g1 = 0, h0 = 0, h1 = 0, h2 = 0;  // moments along the row
      Point<Dim> d = row.d;
      for (Index n = row.begin; n < row.end; ++n) {
        const double along = row.d[0] - static_cast<double>(n - row.begin) * data_.step[0];
        const double g = w.c[n] * w.g[n];
        g0 += g;
        g1 += g * along;
        if (!hessian) continue;
        const double h = w.c[n] * w.h[n];
        h0 += h;
        h1 += h * along;
        h2 += h * along * along;
      }
      d[0] = 0;
      slope += g0 * d;
      slope[0] += g1;
      slopes += g0;
      if (!hessian) continue;
      bend += h0 * d * d.transpose();
      bend.row(0) += h1 * d.transpose();
      bend.col(0) += h1 * d;
      bend(0, 0) += h2;
    }
    if (gradient) {
      Eigen::Map<Point<Dim>> to(out.gradient + Dim * i);
      to = linear_.transpose() * slope / sigma2;
    }
    if (hessian) {
      bend /= sigma2;
      bend.diagonal().array() += slopes;
      const Eigen::Matrix<double, Dim, Dim> H = linear_.transpose() * bend * linear_ / sigma2;
      for (Index a = 0, entry = symmetric_size<Dim> * i; a < Dim; ++a)
        for (Index b = a; b < Dim; ++b, ++entry) out.hessian[entry] = H(a, b);
    }
    add_outside(at, i, out);
  }
}

template <int Dim>
Points<Dim> LatticeField<Dim>::seeds() const {
  Index nodes = 1;
  for (const Index n : data_.size) nodes *= n;
  const auto to_physical = data_.to_lattice.inverse();
  Points<Dim> x(Dim, nodes);
  for (Index i = 0; i < nodes; ++i) {
    Point<Dim> node;
    Index rest = i;
    for (Index a = 0; a < Dim; ++a) {
      node[a] = static_cast<double>(rest % data_.size[a]);
      rest /= data_.size[a];
    }
    x.col(i) = to_physical * node;
  }
  const Eigen::VectorXd f = this->evaluate(x).value;
  std::vector<Point<Dim>> found;
  for (Index i = 0; i < nodes; ++i) {
    Index stride = 1, rest = i;
    for (Index a = 0; a < Dim; stride *= data_.size[a], rest /= data_.size[a], ++a) {
      if (rest % data_.size[a] + 1 == data_.size[a]) continue;
      const Index j = i + stride;
      if ((f[i] > 0) == (f[j] > 0)) continue;
      const double t = f[i] / (f[i] - f[j]);
      const Point<Dim> p = (1 - t) * x.col(i) + t * x.col(j);
      if (data_.bounds.contains(p)) found.push_back(p);
    }
  }
  Points<Dim> seeds(Dim, std::ssize(found));
  for (Index i = 0; i < seeds.cols(); ++i) seeds.col(i) = found[i];
  return seeds;
}

template class LatticeField<2>;
template class LatticeField<3>;
template Box<2> image_box<2>(const Grid&);
template Box<3> image_box<3>(const Grid&);

}  // namespace csrbf
