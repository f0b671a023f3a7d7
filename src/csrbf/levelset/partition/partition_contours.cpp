#include "csrbf/levelset/partition/partition_contours.hpp"

#include "csrbf/levelset/contour/label_contours.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/regions/force_noise.hpp"

namespace csrbf {

template <int Dim>
PartitionContours<Dim> partition_contours(PartitionPrice& price, Partition& partition, int regions,
                                          const LatticeOptions& given, bool spacing_is_given) {
  constexpr double tolerance = 0.05;  // of the price of the contour; by hand: larger loses corners, smaller needs 1
  const std::vector<std::uint8_t> wanted = partition.labels;
  const auto price_of = [&](std::span<const std::uint8_t> labels) {
    return regions == 2 ? fit_blurred(price, labels, partition.model).price
                        : price.fit(labels, partition.model, regions);
  };
  const double least = price_of(wanted);
  std::vector<float> force;
  double contour = 0;
  for (int k = regions == 2 ? 1 : 0; k < regions; ++k)
    contour += contour_price(wanted, static_cast<std::uint8_t>(k), price.grid().size, price.weight());
  if (regions == 2) {
    force.resize(wanted.size());
    price.force(force);
  }
  const auto on_lattice = [&](double spacing) {
    LatticeOptions options = given;
    options.center_spacing = spacing;
    PartitionContours<Dim> result{Lattice<Dim>(price.grid().size, price.grid().spacing, options), spacing, {}};
    if (regions == 2) result.force = mean_magnitude(force);
    partition.labels = wanted;
    result.coefficients = label_contours(result.lattice, force, regions, partition.labels);
    return result;
  };
  if (spacing_is_given) return on_lattice(given.center_spacing);
  for (const double spacing : {4.0, 3.0, 2.0}) {
    if (2 * spacing > static_cast<double>(*std::max_element(price.grid().size.begin(), price.grid().size.end())))
      continue;
    PartitionContours<Dim> result = on_lattice(spacing);
    if (price_of(partition.labels) <= least + tolerance * contour) return result;
  }
  return on_lattice(1);
}

template PartitionContours<2> partition_contours<2>(PartitionPrice&, Partition&, int, const LatticeOptions&, bool);
template PartitionContours<3> partition_contours<3>(PartitionPrice&, Partition&, int, const LatticeOptions&, bool);

}  // namespace csrbf
