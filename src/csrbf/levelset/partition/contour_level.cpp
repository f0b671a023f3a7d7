#include "csrbf/levelset/partition/contour_level.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/contour/segment_fields.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"

#include <algorithm>

namespace csrbf {
namespace {

constexpr double step = 0.1;     // voxels that the contour moves at a time; by hand
constexpr int most_steps = 10;   // a voxel
constexpr double slack = 30;     // nats that a step may cost before the search ends: noise has valleys; by hand
constexpr double parameter = 6;  // nats that the constant has to save: half the logarithm of some 1e5 voxels

template <int Dim>
std::vector<float> values_of(const Lattice<Dim>& lattice, const std::vector<float>& coefficients, std::size_t voxels) {
  std::vector<float> f(voxels);
  lattice.sweep(
      coefficients.data(), false,
      [&](const LatticeRow& row) {
        for (Index i = 0; i < row.count; ++i) f[static_cast<std::size_t>(row.voxel + i * row.stride)] = row.value[i];
        return 0.0;
      },
      nullptr);
  return f;
}

}  // namespace

template <int Dim>
double place_contour_level(PartitionPrice& price, const PartitionModel& model, const Lattice<Dim>& lattice,
                           VariationalResult& contour) {
  std::vector<float>& coefficients = contour.coefficients[0];
  std::vector<std::uint8_t>& labels = contour.labels;
  const BlurredFit now = fit_blurred(price, labels, model);
  const double edge = lattice.spacing().template head<Dim>().minCoeff();
  const double slope = contour_slope(lattice, coefficients) * edge;
  if (!std::isfinite(now.price) || !(slope > 0)) return 0;
  const double before = blurred_likelihood(price, labels, model, now.blur);
  const std::vector<float> f = values_of(lattice, coefficients, labels.size());
  std::vector<std::uint8_t> moved(labels.size());
  double least = before - parameter, off = 0;
  for (const double side : {-step, step}) {
    double last = before;
    for (int k = 1; k <= most_steps; ++k) {
      const double level = side * k * slope;
      for (std::size_t i = 0; i < f.size(); ++i) moved[i] = static_cast<double>(f[i]) + level > 0 ? 1 : 0;
      const double nats = blurred_likelihood(price, moved, model, now.blur);
      if (nats < least) {
        least = nats;
        off = side * k;
      }
      if (!(nats < last + slack)) break;
      last = std::min(last, nats);
    }
    if (off != 0) break;
  }
  if (off == 0) return 0;
  for (float& each : coefficients) each += static_cast<float>(off * slope);  // f of coefficients 1 is about 1
  update_labels(lattice, coefficients, labels.data());
  return off;
}

template double place_contour_level<2>(PartitionPrice&, const PartitionModel&, const Lattice<2>&, VariationalResult&);
template double place_contour_level<3>(PartitionPrice&, const PartitionModel&, const Lattice<3>&, VariationalResult&);

}  // namespace csrbf
