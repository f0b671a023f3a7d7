#include "csrbf/levelset/partition/partition_contours.hpp"

#include "csrbf/levelset/contour/contour_energy.hpp"
#include "csrbf/levelset/contour/label_contours.hpp"
#include "csrbf/levelset/contour/segment_fields.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/regions/force_noise.hpp"

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
PartitionContours<Dim> write_contours(const Grid& grid, std::vector<std::uint8_t>& labels, int regions,
                                      const ContourPrice& judge, const LatticeOptions& given, bool spacing_is_given) {
  const std::vector<std::uint8_t> wanted = labels;
  const auto on_lattice = [&](double spacing) {
    LatticeOptions options = given;
    options.center_spacing = spacing;
    PartitionContours<Dim> result{Lattice<Dim>(grid.size, grid.spacing, options), spacing, {}};
    if (regions == 2) result.force = mean_magnitude(judge.force);
    labels = wanted;
    result.coefficients = label_contours(result.lattice, judge.force, regions, labels);
    return result;
  };
  if (spacing_is_given) return on_lattice(given.center_spacing);
  for (const double spacing : {4.0, 3.0, 2.0}) {
    if (2 * spacing > static_cast<double>(*std::max_element(grid.size.begin(), grid.size.end()))) continue;
    PartitionContours<Dim> result = on_lattice(spacing);
    if (judge.price(labels) <= judge.most) return result;
  }
  return on_lattice(1);
}

template <int Dim>
PartitionContours<Dim> partition_contours(PartitionPrice& price, Partition& partition, int regions,
                                          const LatticeOptions& given, bool spacing_is_given) {
  const auto price_of = [&](std::span<const std::uint8_t> labels) {
    return regions == 2 ? fit_blurred(price, labels, partition.model).price
                        : price.fit(labels, partition.model, regions);
  };
  std::vector<float> force;
  double contour = 0;
  for (int k = regions == 2 ? 1 : 0; k < regions; ++k)
    contour += contour_price(partition.labels, static_cast<std::uint8_t>(k), price.grid().size, price.weight());
  const double most = price_of(partition.labels) + contour_tolerance * contour;
  if (regions == 2) {
    force.resize(partition.labels.size());
    price.force(force);
  }
  return write_contours<Dim>(price.grid(), partition.labels, regions, {price_of, most, force}, given, spacing_is_given);
}

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

template PartitionContours<2> partition_contours<2>(PartitionPrice&, Partition&, int, const LatticeOptions&, bool);
template PartitionContours<3> partition_contours<3>(PartitionPrice&, Partition&, int, const LatticeOptions&, bool);
template PartitionContours<2> write_contours<2>(const Grid&, std::vector<std::uint8_t>&, int, const ContourPrice&,
                                                const LatticeOptions&, bool);
template PartitionContours<3> write_contours<3>(const Grid&, std::vector<std::uint8_t>&, int, const ContourPrice&,
                                                const LatticeOptions&, bool);
template double place_contour_level<2>(PartitionPrice&, const PartitionModel&, const Lattice<2>&, VariationalResult&);
template double place_contour_level<3>(PartitionPrice&, const PartitionModel&, const Lattice<3>&, VariationalResult&);

}  // namespace csrbf
