#include "csrbf/levelset/partition/partition_contours.hpp"

#include "csrbf/levelset/contour/label_contours.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/regions/force_noise.hpp"

namespace csrbf {

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

template PartitionContours<2> partition_contours<2>(PartitionPrice&, Partition&, int, const LatticeOptions&, bool);
template PartitionContours<3> partition_contours<3>(PartitionPrice&, Partition&, int, const LatticeOptions&, bool);
template PartitionContours<2> write_contours<2>(const Grid&, std::vector<std::uint8_t>&, int, const ContourPrice&,
                                                const LatticeOptions&, bool);
template PartitionContours<3> write_contours<3>(const Grid&, std::vector<std::uint8_t>&, int, const ContourPrice&,
                                                const LatticeOptions&, bool);

}  // namespace csrbf
