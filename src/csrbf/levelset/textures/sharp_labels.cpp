#include "csrbf/levelset/textures/sharp_labels.hpp"

#include "csrbf/levelset/image/edgeless_share.hpp"
#include "csrbf/levelset/textures/neighbour_code.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace csrbf {
namespace {

// Of what regions differ by close to their border, from one voxel to the next; by hand: labels of nuclei, as of all
// that a camera blurs, have at most 0.62.
constexpr double sharp = 0.8;
constexpr double differs = 0.02;  // labels, of the smaller region: fewer are the same contour
constexpr double clearly = 0.1;   // of the price of the contour; by hand: less is a matter of chance

class SharpLabels {
 public:
  explicit SharpLabels(PartitionPrice& price) : price_(price) {}

  void prefer(Partition& found, const Progress& progress) {
    const ModelLabels* best = nullptr;
    double least = 0;
    for (const ModelLabels& other : found.others) {
      if (!differ(other.labels, found.labels) || sharpness(other.labels) < sharp) continue;
      const double nats = price_of(other.labels);
      if (best != nullptr && nats >= least) continue;
      best = &other;
      least = nats;
    }
    if (best == nullptr) return;
    const double most = std::min(price_of(found.labels), price_of_one_region());
    if (!is_better(least, best->labels, most)) return;
    PartitionOptions options;
    options.model = cheapest_model(best->labels, found);
    options.start = best->labels;
    options.progress = progress;
    Partition followed = find_partition(price_, options);
    if (followed.labels.empty()) return;
    const double end = price_.fit(followed.labels, followed.model);
    if (price_of(followed.labels) > least) followed.labels = best->labels;
    const double chosen = price_.fit(found.labels, found.model), now = price_.fit(followed.labels, followed.model);
    followed.gain += end - now;
    followed.iterations += found.iterations;
    followed.prices = std::move(found.prices);
    for (ModelPrice& each : followed.prices) each.nats = each.model == followed.model ? 0 : each.nats + chosen - now;
    found = std::move(followed);
  }

 private:
  [[nodiscard]] bool differ(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) const {
    double different = 0, ones = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (!price_.inside(i)) continue;
      different += (a[i] != 0) != (b[i] != 0) ? 1 : 0;
      ones += b[i] != 0 ? 1 : 0;
    }
    const double all = price_.voxels();
    return std::min(different, all - different) > differs * std::min(ones, all - ones);
  }

  [[nodiscard]] double sharpness(std::span<const std::uint8_t> labels) const {
    return border_sharpness(price_.values(), labels, price_.grid(), price_.mask());
  }

  double price_of_one_region() {
    return least_of_shapes({}, [&](MeanShape shape) { return price_.price_of_one_region({shape}); });
  }

  PartitionModel cheapest_model(std::span<const std::uint8_t> labels, const Partition& found) {
    const LabelMeasures measures = price_.measure(labels);
    PartitionModel result = found.model;
    double least = price_.fit(labels, measures, result);
    for (const ModelLabels& other : found.others) {
      const double nats = price_.fit(labels, measures, other.model);
      if (nats < least) result = other.model;
      least = std::min(least, nats);
    }
    return result;
  }

  double price_of(std::span<const std::uint8_t> labels) {
    const LabelMeasures measures = price_.measure(labels);
    return least_of_shapes(labels, [&](MeanShape shape) { return price_.fit(labels, measures, {shape}); }) +
           measures.price;
  }

  // About means of each shape, with the parameters that it has more than a constant: predictions by neighbours follow
  // light only where there is little noise.
  template <class Fit>
  double least_of_shapes(std::span<const std::uint8_t> labels, const Fit& fit) {
    const std::vector<std::uint8_t> one(labels.empty() ? price_.values().size() : 0, 0);
    double least = std::numeric_limits<double>::infinity(), of_constant = 0;
    for (const MeanShape shape : {MeanShape::constant, MeanShape::quadratic, MeanShape::smooth}) {
      const double whole = fit(shape), others = whole - price_.deviation_price();
      if (shape == MeanShape::constant) of_constant = others;
      const double nats = code_of(price_.rest(labels.empty() ? one : labels)).fit(labels) + others - of_constant;
      least = std::min(least, nats);
    }
    return least;
  }

  [[nodiscard]] bool is_better(double nats, std::span<const std::uint8_t> labels, double most) const {
    return nats < most - clearly * contour_price(labels, 1, price_.grid().size, price_.weight());
  }

  // The values must outlive it.
  [[nodiscard]] NeighbourCode code_of(std::span<const float> values) const {
    return {values, price_.grid(), price_.mask(), price_.least_deviation()};
  }

  PartitionPrice& price_;
};

}  // namespace

void prefer_sharp_labels(PartitionPrice& price, Partition& found, const Progress& progress) {
  const bool two = std::all_of(found.labels.begin(), found.labels.end(), [](std::uint8_t label) { return label < 2; });
  if (two && price.grain() == 1 && price.seeds().empty()) SharpLabels(price).prefer(found, progress);
}

}  // namespace csrbf
