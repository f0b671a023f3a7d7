#include "csrbf/levelset/textures/texture_partition.hpp"

#include "csrbf/levelset/image/gaussian_blur.hpp"
#include "csrbf/levelset/image/noise_grain.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/regions/intensity_classes.hpp"
#include "csrbf/levelset/textures/neighbour_code.hpp"

#include <limits>

namespace csrbf {
namespace {

constexpr std::array<double, 3> widths{1.5, 3, 6};  // of the Gaussians that start, in voxels; by hand
constexpr int most_rounds = 15;                     // of statistics and contours
constexpr double least_gain = 0.5;                  // nats: less is not worth a round
// Of what textures tell that intensities may; by hand: in 57 images of nuclei these tell at least 0.79 of what their
// borders do as textures, in textures of the same mean at most 0.21.
constexpr double others_share = 0.5;
// Of it that predictions tell and deviations do not; by hand: of textures at least 0.48, of heavy tails at most 0.01.
constexpr double own_share = 0.25;
constexpr double hardly = 0.2;  // of a variance that is predicted; by hand: few photons have up to 0.15

NeighbourCode code_of(const PartitionPrice& price, std::span<const float> values) {
  return {values, price.grid(), price.mask(), price.least_deviation()};
}

class TextureSearch {
 public:
  explicit TextureSearch(PartitionPrice& price) : price_(price), code_(code_of(price, price.values())) {}

  std::optional<TexturePartition> run(const Partition& found) {
    if (found.labels.empty() || are_clear(price_, found.labels, found.model)) return std::nullopt;
    const double one = price_of_one_region(), told = one - price_of(found);
    const auto tell_more = [&](double gain) { return gain > 0 && told <= others_share * gain; };
    std::vector<Partition> tried;
    for (const double width : widths) {
      Partition each;
      each.labels = start(width);
      // Without their contours labels seem to tell more than they will.
      if (each.labels.empty() || !tell_more(one - code_.fit(each.labels))) continue;
      each.energy = {price_of(each.labels)};
      follow(each, 1);
      tried.push_back(std::move(each));
    }
    if (tried.empty()) return std::nullopt;
    Partition& best = *std::min_element(tried.begin(), tried.end(),
                                        [](const auto& a, const auto& b) { return a.energy.back() < b.energy.back(); });
    follow(best, most_rounds);
    best.gain = one - best.energy.back();
    const double without = code_.fit(best.labels, false), with = code_.fit(best.labels);
    if (!tell_more(best.gain) || without - with < own_share * best.gain) return std::nullopt;
    if (std::max(code_.predicted(0), code_.predicted(1)) < hardly) return std::nullopt;
    if (!is_noise(best.labels, 0) || !is_noise(best.labels, 1)) return std::nullopt;
    best.model.own_deviations = true;
    best.prices = found.prices;
    TexturePartition result{std::move(best), std::vector<float>(price_.values().size()), {}};
    code_.force(result.force);
    result.predicted = {code_.predicted(0), code_.predicted(1)};
    return result;
  }

 private:
  // Whose mean may be a polynomial.
  double price_of_one_region() {
    double least = code_.fit({});
    std::vector<float> rest(price_.values().size());
    const double parameters = 0.5 * std::log(price_.voxels());
    double count = 0;
    for (const int degree : {1, 2}) {
      price_.fill_trend(price_.values(), degree, rest);
      for (std::size_t i = 0; i < rest.size(); ++i) rest[i] = price_.values()[i] - rest[i];
      count += price_.grid().dimension() * (degree == 1 ? 1.0 : 0.5 * (price_.grid().dimension() + 1));
      least = std::min(least, code_of(price_, rest).fit({}) + parameters * count);
    }
    return least;
  }

  // What the means of regions of intensities leave is a texture, too: the same in both, or not.
  double price_of(const Partition& found) {
    const std::vector<float> rest = fit_blurred(price_, found.labels, found.model).residual;
    const double others = price_.fit(found.labels, found.model) - price_.deviation_price();
    return others + std::min(code_of(price_, rest).fit({}), code_of(price_, rest).fit(found.labels));
  }

  // Whether the voxels of a region are like their neighbours, but not like those beyond these: what light or structures
  // in a region have in common is no texture.
  bool is_noise(const std::vector<std::uint8_t>& labels, std::uint8_t region) const {
    if (code_.predicted(region) < hardly) return true;
    std::vector<std::uint8_t> mask(labels.size());
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      mask[i] = labels[i] == region && price_.inside(i) ? 1 : 0;
      if (mask[i] == 0) continue;
      sum += static_cast<double>(price_.values()[i]);
      count += 1;
    }
    std::vector<float> rest(price_.values().begin(), price_.values().end());
    for (float& value : rest) value -= static_cast<float>(sum / count);
    return noise_grain(rest, price_.grid(), mask) > 1;
  }

  // Classes of how voxels are like their neighbours, on average around each.
  [[nodiscard]] std::vector<std::uint8_t> start(double width) const {
    std::vector<float> f(price_.values().size());
    code_.fill_products(f);
    std::array<double, 3> along{0, 0, 0};
    for (std::size_t a = 0; a < 3; ++a) along[a] = width * price_.weight().along[a];
    gaussian_blur(f, price_.grid().size, along);
    const IntensityBins bins = choose_bins(f, 256, price_.mask());
    if (!(bins.hi > bins.lo)) return {};
    Histogram histogram(bins);
    for (std::size_t i = 0; i < f.size(); ++i)
      if (price_.inside(i)) histogram.add(static_cast<double>(f[i]));
    if (std::count_if(histogram.counts.begin(), histogram.counts.end(), [](double c) { return c > 0; }) < 2) return {};
    const double limit = optimal_classes(histogram, 2).thresholds[0];
    std::vector<std::uint8_t> labels(f.size());
    for (std::size_t i = 0; i < f.size(); ++i) labels[i] = static_cast<double>(f[i]) > limit ? 1 : 0;
    return labels;
  }

  double price_of(const std::vector<std::uint8_t>& labels) { return code_.fit(labels) + price_.measure(labels).price; }

  // Predictions and contours in turns while the price falls.
  void follow(Partition& result, int rounds) {
    ContourState state;
    std::vector<float> force(result.labels.size());
    std::vector<std::uint8_t> labels = result.labels;
    for (int round = 0; round < rounds && !result.converged; ++round) {
      ++result.iterations;
      code_.fit(labels);
      code_.force(force);
      convex_contour(price_.grid().size, price_.weight(), force, labels, &state);
      price_.drop_parts(force, labels);
      const double now = price_of(labels);
      result.converged = now >= result.energy.back() - least_gain;
      if (now >= result.energy.back()) return;
      result.labels = labels;
      result.energy.push_back(now);
    }
  }

  PartitionPrice& price_;
  NeighbourCode code_;
};

}  // namespace

std::optional<TexturePartition> find_texture_partition(PartitionPrice& price, const Partition& found) {
  return TextureSearch(price).run(found);
}

template <int Dim>
PartitionContours<Dim> texture_contours(PartitionPrice& price, Partition& partition, std::span<const float> force,
                                        const LatticeOptions& given, bool spacing_is_given) {
  NeighbourCode code = code_of(price, price.values());
  const auto price_of = [&](std::span<const std::uint8_t> labels) {
    return code.fit(labels) + price.measure(labels).price;
  };
  const double contour = contour_price(partition.labels, 1, price.grid().size, price.weight());
  const double most = price_of(partition.labels) + contour_tolerance * contour;
  return write_contours<Dim>(price.grid(), partition.labels, 2, {price_of, most, force}, given, spacing_is_given);
}

template PartitionContours<2> texture_contours<2>(PartitionPrice&, Partition&, std::span<const float>,
                                                  const LatticeOptions&, bool);
template PartitionContours<3> texture_contours<3>(PartitionPrice&, Partition&, std::span<const float>,
                                                  const LatticeOptions&, bool);

}  // namespace csrbf
