#include "csrbf/approx/samples/sphere_field.hpp"

#include "csrbf/spatial/morton_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace csrbf {
namespace {

constexpr double degrees = 180 / std::numbers::pi;  // per radian
const double reach_cosine = std::cos(chart_reach / degrees);
// Sum of the weights where three of six charts meet, the least there is when none is missing.
const double full_cover = 3 * std::pow((std::sqrt(1.0 / 3) - reach_cosine) / (1 - reach_cosine), 4);

// cos and sin of an angle in degrees.
std::pair<double, double> cos_sin(double angle) {
  if (!std::isfinite(angle))
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const double turn = std::remainder(angle, 360.0), quarter = std::round(turn / 90);
  const double rest = (turn - 90 * quarter) / degrees, c = std::cos(rest), s = std::sin(rest);
  switch ((static_cast<int>(quarter) + 4) % 4) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

// A function of longitude and latitude with two derivatives, per degree.
struct AngleJet {
  double f = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
};

AngleJet operator*(double a, const AngleJet& b) {
  return {a * b.f, a * b.x, a * b.y, a * b.xx, a * b.xy, a * b.yy};
}

AngleJet operator+(const AngleJet& a, const AngleJet& b) {
  return {a.f + b.f, a.x + b.x, a.y + b.y, a.xx + b.xx, a.xy + b.xy, a.yy + b.yy};
}

AngleJet operator*(const AngleJet& a, const AngleJet& b) {
  return {a.f * b.f,
          a.x * b.f + a.f * b.x,
          a.y * b.f + a.f * b.y,
          a.xx * b.f + 2 * a.x * b.x + a.f * b.xx,
          a.xy * b.f + a.x * b.y + a.y * b.x + a.f * b.xy,
          a.yy * b.f + 2 * a.y * b.y + a.f * b.yy};
}

// g(a) with g' and g'' at a.
AngleJet chain(double g, double dg, double ddg, const AngleJet& a) {
  return {g, dg * a.x, dg * a.y, ddg * a.x * a.x + dg * a.xx, ddg * a.x * a.y + dg * a.xy, ddg * a.y * a.y + dg * a.yy};
}

std::array<AngleJet, 3> direction(double longitude, double latitude) {
  const auto [cx, sx] = cos_sin(longitude);
  const auto [cy, sy] = cos_sin(latitude);
  constexpr double r = 1 / degrees, r2 = r * r;
  return {{{cx * cy, -r * sx * cy, -r * cx * sy, -r2 * cx * cy, r2 * sx * sy, -r2 * cx * cy},
           {sx * cy, r * cx * cy, -r * sx * sy, -r2 * sx * cy, -r2 * cx * sy, -r2 * sx * cy},
           {sy, 0, r * cy, 0, 0, -r2 * sy}}};
}

AngleJet along(const Eigen::Matrix3d& axes, Index row, const std::array<AngleJet, 3>& u) {
  return axes(row, 0) * u[0] + axes(row, 1) * u[1] + axes(row, 2) * u[2];
}

constexpr double least_height = 1e-12;  // of 1 + cos(angle): beyond is the point opposite to the middle

std::array<AngleJet, 2> chart_coordinates(const Eigen::Matrix3d& axes, const std::array<AngleJet, 3>& u) {
  const AngleJet height = along(axes, 2, u);
  const double h = std::max(1 + height.f, least_height), factor = 2 * degrees / h;
  const AngleJet scale = chain(factor, -factor / h, 2 * factor / (h * h), height);
  return {scale * along(axes, 0, u), scale * along(axes, 1, u)};
}

// Weight of a chart whose middle is at an angle with this cosine.
AngleJet weight(const AngleJet& cosine) {
  const double width = 1 - reach_cosine, t = (cosine.f - reach_cosine) / width;
  if (!(t > 0)) return {};
  return chain(t * t * t * t, 4 * t * t * t / width, 12 * t * t / (width * width), cosine);
}

// The axes that are neither longitude nor latitude.
template <int Dim>
std::vector<Index> other_axes(int longitude, int latitude) {
  std::vector<Index> others;
  for (int a = 0; a < Dim; ++a)
    if (a != longitude && a != latitude) others.push_back(a);
  return others;
}

// A jet in the coordinates of the user.
template <int Dim>
struct PlaceJet {
  double value = 0;
  Point<Dim> gradient = Point<Dim>::Zero();
  Eigen::Matrix<double, Dim, Dim> hessian = Eigen::Matrix<double, Dim, Dim>::Zero();

  void add(const PlaceJet& f, const AngleJet& w, int longitude, int latitude) {
    Point<Dim> g = Point<Dim>::Zero();
    Eigen::Matrix<double, Dim, Dim> h = Eigen::Matrix<double, Dim, Dim>::Zero();
    g[longitude] = w.x;
    g[latitude] = w.y;
    h(longitude, longitude) = w.xx;
    h(longitude, latitude) = h(latitude, longitude) = w.xy;
    h(latitude, latitude) = w.yy;
    value += w.f * f.value;
    gradient += w.f * f.gradient + f.value * g;
    hessian += w.f * f.hessian + f.gradient * g.transpose() + g * f.gradient.transpose() + f.value * h;
  }
};

// The jet of a field of `Inner` coordinates, the first of which are functions of longitude and latitude.
template <int Dim, int Inner, std::size_t Mapped>
PlaceJet<Dim> pulled_back(const Jet<Inner>& jet, Index i, const std::array<AngleJet, Mapped>& y, int longitude,
                          int latitude) {
  PlaceJet<Dim> result;
  result.value = jet.value[i];
  if (jet.gradient.cols() == 0) return result;
  Eigen::Matrix<double, Inner, Dim> J = Eigen::Matrix<double, Inner, Dim>::Zero();
  for (std::size_t e = 0; e < Mapped; ++e) {
    J(static_cast<Index>(e), longitude) = y[e].x;
    J(static_cast<Index>(e), latitude) = y[e].y;
  }
  Index row = Mapped;
  for (const Index a : other_axes<Dim>(longitude, latitude)) J(row++, a) = 1;
  result.gradient = J.transpose() * jet.gradient.col(i);
  if (jet.hessian.cols() == 0) return result;
  result.hessian = J.transpose() * jet.hessian_matrix(i) * J;
  for (std::size_t e = 0; e < Mapped; ++e) {
    const double g = jet.gradient(static_cast<Index>(e), i);
    result.hessian(longitude, longitude) += g * y[e].xx;
    result.hessian(longitude, latitude) += g * y[e].xy;
    result.hessian(latitude, longitude) += g * y[e].xy;
    result.hessian(latitude, latitude) += g * y[e].yy;
  }
  return result;
}

// Coordinates of a field whose first ones are given.
template <int Dim, int Inner, std::size_t Mapped>
Point<Inner> place(const std::array<AngleJet, Mapped>& y, const Point<Dim>& x, const std::vector<Index>& others) {
  Point<Inner> result;
  for (std::size_t e = 0; e < Mapped; ++e) result[static_cast<Index>(e)] = y[e].f;
  Index row = Mapped;
  for (const Index a : others) result[row++] = x[a];
  return result;
}

template <int Inner>
Jet<Inner> evaluated(const Field<Inner>& field, const Points<Inner>& y, Derivatives derivatives) {
  Jet<Inner> jet(y.cols(), derivatives);
  field.evaluate_block(y, {jet.value.data(), jet.gradient.cols() > 0 ? jet.gradient.data() : nullptr,
                           jet.hessian.cols() > 0 ? jet.hessian.data() : nullptr});
  return jet;
}

std::array<AngleJet, 3> in_degrees(const std::array<AngleJet, 3>& u) {
  return {degrees * u[0], degrees * u[1], degrees * u[2]};
}

template <int Dim>
void store(const PlaceJet<Dim>& f, Index i, const JetBlock& out) {
  out.value[i] = f.value;
  if (out.gradient != nullptr) std::copy_n(f.gradient.data(), Dim, out.gradient + Dim * i);
  if (out.hessian == nullptr) return;
  double* entry = out.hessian + symmetric_size<Dim> * i;
  for (int a = 0; a < Dim; ++a)
    for (int b = a; b < Dim; ++b) *entry++ = f.hessian(a, b);
}

// Evaluates the parts of a SphereField in a block of points.
template <int Dim>
class PartEvaluation {
  static constexpr int space_dim = SphereField<Dim>::space_dim;
  using Parts = typename SphereField<Dim>::Parts;

 public:
  PartEvaluation(const Parts& parts, const PointsRef<Dim>& x, Derivatives derivatives)
      : parts_(parts), x_(x), derivatives_(derivatives), sum_(x.cols()), weights_(x.cols()) {
    u_.reserve(x.cols());
    for (Index i = 0; i < x.cols(); ++i) u_.push_back(direction(x(parts.longitude, i), x(parts.latitude, i)));
  }

  void evaluate(const JetBlock& out) {
    for (const auto& part : parts_.charts) add_chart(part);
    if (parts_.space) add_space();
    for (Index i = 0; i < x_.cols(); ++i) {
      PlaceJet<Dim> f;
      f.add(sum_[i],
            chain(1 / weights_[i].f, -1 / (weights_[i].f * weights_[i].f),
                  2 / (weights_[i].f * weights_[i].f * weights_[i].f), weights_[i]),
            parts_.longitude, parts_.latitude);
      if (!x_.col(i).allFinite()) f.value = std::numeric_limits<double>::quiet_NaN();
      store(f, i, out);
    }
  }

 private:
  void add_chart(const typename SphereField<Dim>::Part& part) {
    const bool alone = parts_.charts.size() == 1 && !parts_.space;
    std::vector<Index> here;
    std::vector<AngleJet> w;
    for (Index i = 0; i < x_.cols(); ++i) {
      const AngleJet one = alone ? AngleJet{1} : weight(along(part.chart.axes, 2, u_[i]));
      if (!(one.f > 0)) continue;
      here.push_back(i);
      w.push_back(one);
    }
    if (here.empty()) return;
    Points<Dim> y(Dim, std::ssize(here));
    std::vector<std::array<AngleJet, 2>> maps;
    for (std::size_t k = 0; k < here.size(); ++k) {
      maps.push_back(chart_coordinates(part.chart.axes, u_[here[k]]));
      y.col(static_cast<Index>(k)) = place<Dim, Dim>(maps.back(), Point<Dim>(x_.col(here[k])), others_);
    }
    add(evaluated<Dim>(*part.field, y, derivatives_), here, maps, w);
  }

  void add_space() {
    std::vector<Index> here;
    std::vector<AngleJet> w;
    Points<space_dim> y(space_dim, x_.cols());
    std::vector<std::array<AngleJet, 3>> maps;
    for (Index i = 0; i < x_.cols(); ++i) {
      AngleJet one{1};
      if (!parts_.charts.empty()) {
        const double bare = 1 - weights_[i].f / full_cover;
        if (!(bare > 0)) continue;
        const double b2 = bare * bare;
        one = chain(full_cover * b2 * b2, -4 * b2 * bare, 12 * b2 / full_cover, weights_[i]);
      }
      maps.push_back(in_degrees(u_[i]));
      if constexpr (space_dim > Dim)
        y.col(std::ssize(here)) = place<Dim, space_dim>(maps.back(), Point<Dim>(x_.col(i)), others_);
      here.push_back(i);
      w.push_back(one);
    }
    if (here.empty()) return;
    if constexpr (space_dim > Dim)
      add(evaluated<space_dim>(*parts_.space, y.leftCols(std::ssize(here)), derivatives_), here, maps, w);
  }

  template <int Inner, std::size_t Mapped>
  void add(const Jet<Inner>& jet, const std::vector<Index>& here, const std::vector<std::array<AngleJet, Mapped>>& maps,
           const std::vector<AngleJet>& w) {
    for (std::size_t k = 0; k < here.size(); ++k) {
      const Index i = here[k];
      sum_[i].add(pulled_back<Dim>(jet, static_cast<Index>(k), maps[k], parts_.longitude, parts_.latitude), w[k],
                  parts_.longitude, parts_.latitude);
      weights_[i] = weights_[i] + w[k];
    }
  }

  const Parts& parts_;
  const PointsRef<Dim>& x_;
  Derivatives derivatives_;
  std::vector<Index> others_ = other_axes<Dim>(parts_.longitude, parts_.latitude);
  std::vector<std::array<AngleJet, 3>> u_;
  std::vector<PlaceJet<Dim>> sum_;
  std::vector<AngleJet> weights_;
};

}  // namespace

Point<3> point_on_sphere(double longitude, double latitude) {
  const auto [cx, sx] = cos_sin(longitude);
  const auto [cy, sy] = cos_sin(latitude);
  return {cx * cy, sx * cy, sy};
}

template <int Dim>
void SphereField<Dim>::evaluate_block(const PointsRef<Dim>& x, const JetBlock& out) const {
  if constexpr (Dim > 1) PartEvaluation<Dim>(parts_, x, out.derivatives()).evaluate(out);
}

template <int Dim>
std::vector<Index> SphereField<Dim>::evaluation_order(const PointsRef<Dim>& x) const {
  return rough_morton_order<Dim>(x);
}

template <int Dim>
double SphereField<Dim>::feature_size() const {
  double size = parts_.space ? parts_.space->feature_size() : std::numeric_limits<double>::infinity();
  for (const Part& part : parts_.charts) size = std::min(size, part.field->feature_size());
  return size;
}

template <int Dim>
Points<Dim> SphereField<Dim>::in_chart(const PointsRef<Dim>& x, int longitude, int latitude, const SphereChart& chart) {
  const std::vector<Index> others = other_axes<Dim>(longitude, latitude);
  Points<Dim> y(Dim, x.cols());
  if constexpr (Dim > 1)
    for (Index i = 0; i < x.cols(); ++i)
      y.col(i) = place<Dim, Dim>(chart_coordinates(chart.axes, direction(x(longitude, i), x(latitude, i))),
                                 Point<Dim>(x.col(i)), others);
  return y;
}

template <int Dim>
Points<SphereField<Dim>::space_dim> SphereField<Dim>::in_space(const PointsRef<Dim>& x, int longitude, int latitude) {
  const std::vector<Index> others = other_axes<Dim>(longitude, latitude);
  Points<space_dim> y(space_dim, x.cols());
  if constexpr (Dim > 1 && space_dim > Dim)
    for (Index i = 0; i < x.cols(); ++i)
      y.col(i) =
          place<Dim, space_dim>(in_degrees(direction(x(longitude, i), x(latitude, i))), Point<Dim>(x.col(i)), others);
  return y;
}

#define CSRBF_INSTANTIATE(Dim) template class SphereField<Dim>;
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
