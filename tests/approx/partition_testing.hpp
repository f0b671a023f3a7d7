#pragma once

#include "csrbf/approx/unity/partition_of_unity.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf {

/// A local function at x, term by term.
template <int Dim>
double plain_value(const LocalModels<Dim>& models, Index i, Index component, const Point<Dim>& x) {
  Point<Dim> q = (x - models.center.col(i)) / models.radius[i];
  if (models.anisotropic)
    q = Eigen::Map<const Eigen::Matrix<double, Dim, Dim>>(models.metric.data() + Dim * Dim * i) * q;
  const Polynomials<Dim> monomials(models.degree);
  const Index row = i * models.components + component;
  double sum = 0;
  for (Index j = 0; j < monomials.size(); ++j) {
    double monomial = 1;
    for (int a = 0; a < Dim; ++a) monomial *= std::pow(q[a], monomials.exponents(j)[a]);
    sum += models.polynomial[row * monomials.size() + j] * monomial;
  }
  const Index M = models.centers_each;
  for (Index j = 0; j < M; ++j) {
    const Eigen::Map<const Point<Dim>> center(models.position.data() + Dim * (M * i + j));
    sum += models.alpha[row * M + j] * models.kernel.value((q - center).norm() / models.support);
  }
  return sum;
}

/// A partition of unity at x inside its box, support by support.
template <int Dim>
double plain_value(const typename PartitionOfUnity<Dim>::Data& data, Index component, const Point<Dim>& x) {
  double weights = 0;
  double sum = 0;
  for (Index i = 0; i < data.cover.size(); ++i) {
    const Box<Dim>& cell = data.cover.cell(i);
    double weight = 1;
    for (int a = 0; a < Dim; ++a) {
      const double t = (x[a] - cell.center()[a]) / (0.5 * data.cover.growth() * cell.extent()[a]);
      weight *= std::pow(std::max(0.0, 1 - t * t), 4);
    }
    if (weight == 0) continue;
    weights += weight;
    sum += weight * plain_value(data.models, i, component, x);
  }
  return sum / weights;
}

template <int Dim>
std::shared_ptr<const Field<Dim>> partition_field(const Samples<Dim>& samples,
                                                  const PartitionOfUnityOptions& options = {}) {
  return partition_of_unity<Dim>(samples, options).fields()[0];
}

/// Points on faces between cells, where supports begin or end next to each other.
template <int Dim>
Points<Dim> points_on_borders(const Cover<Dim>& cover, Index count, unsigned seed) {
  Points<Dim> points = random_points<Dim>(count, seed);
  for (Index i = 0; i < count; ++i) {
    const Box<Dim>& cell = cover.cell((7 * i) % cover.size());
    points.col(i) = cell.lo + points.col(i).cwiseProduct(cell.extent());
    const int a = static_cast<int>(i % Dim);
    const bool outer = cell.hi[a] == cover.box().hi[a];
    points(a, i) = outer ? cell.lo[a] : cell.hi[a];
    if (points(a, i) == cover.box().lo[a]) points(a, i) = cell.center()[a];
  }
  return points;
}

}  // namespace csrbf
