#include "csrbf/levelset/segmenter.hpp"

#include "csrbf/levelset/baselines/follow_baseline.hpp"
#include "csrbf/levelset/contour/edge_flow.hpp"
#include "csrbf/levelset/contour/label_contours.hpp"
#include "csrbf/levelset/contour/region_order.hpp"
#include "csrbf/levelset/contour/segment_fields.hpp"
#include "csrbf/levelset/contour/speckle_place.hpp"
#include "csrbf/levelset/contour/variational.hpp"
#include "csrbf/levelset/disturbances/calm_partition.hpp"
#include "csrbf/levelset/disturbances/region_levels.hpp"
#include "csrbf/levelset/image/impulse_noise.hpp"
#include "csrbf/levelset/law_partition.hpp"
#include "csrbf/levelset/partition/blurred_classes.hpp"
#include "csrbf/levelset/partition/blurred_price.hpp"
#include "csrbf/levelset/partition/grained_partition.hpp"
#include "csrbf/levelset/partition/partition_contours.hpp"
#include "csrbf/levelset/partition/seed_prior.hpp"
#include "csrbf/levelset/regions/caller_forces.hpp"
#include "csrbf/levelset/regions/force_noise.hpp"
#include "csrbf/levelset/regions/region_forces.hpp"
#include "csrbf/levelset/regions/region_labels.hpp"
#include "csrbf/levelset/seeded/divide_by_seeds.hpp"
#include "csrbf/levelset/segment_checks.hpp"
#include "csrbf/levelset/textures/sharp_labels.hpp"
#include "csrbf/levelset/textures/texture_partition.hpp"

#include <utility>

namespace csrbf {
namespace {

template <int Dim>
class Segmenter {
 public:
  Segmenter(const Volume<float>& image, const SegmentOptions& options)
      : image_(image),
        options_(options),
        grid_(image.grid),
        used_(choose_settings(options, image.grid.voxels())),
        seeds_(seed_costs(options.seeds, options.seed_confidence, options.seed_confidences, options.regions)) {}

  // The values, the source of the forces and the labels that the statistics start from.
  void start() {
    repaired_ = finite_values(image_, options_.mask);
    values_ = given_values();
    check_contrast(values_, options_.mask);
    report(options_.progress, "prepare", 0);
    if (is_large(options_, grid_.voxels()) && partition_large()) return;
    if (chooses_model()) report_.impulses = repair_impulses(values_, grid_, options_.mask, repaired_);
    values_ = given_values();
    prior_ = chooses_model() ? options_.prior : prior_of_seeds(options_, seeds_, grid_, is_local());
    regions_.emplace(values_, grid_, options_.mask, law_of(options_.energy), options_.regions, prior_);
    if (options_.force) caller_.emplace(options_);
    const bool follows_seed = !options_.seed.empty() && (is_local() || !is_variational() || options_.force);
    given_ = options_.start.empty() && follows_seed ? options_.seed : options_.start;
    for (std::uint8_t& label : given_) label = label != 0 ? 1 : 0;
    labels_ = !given_.empty() && options_.force ? given_ : regions_->start();
    if (options_.regions == 2) match_seeds(options_.seeds, labels_);
  }

  // The noise of the forces between the two classes of the image, wherever a seed lies, and what is chosen by it.
  void measure() {
    if (!fields_.empty()) return;
    source().fit(labels_);
    noise_ = force_noise(source(), labels_, options_.mask, grid_);
    constexpr double speckle = 1.5;  // grain above which the laws are wide enough for borders; by hand
    if (noise_.grain > speckle) {
      regions_->set_border(0);
      source().fit(labels_);
    }
    if (!used_.window) used_.window = choose_window(options_, noise_, Dim);
    if (*used_.window > 0) {
      regions_->set_window(*used_.window);
      noise_ = force_noise(source(), labels_, options_.mask, grid_);
    }
    if (!given_.empty()) {
      labels_ = std::move(given_);
      source().fit(labels_);
    }
    if (!used_.center_spacing && !chooses_model()) used_.center_spacing = choose_center_spacing(noise_, Dim);
  }

  // Labels and level sets.
  void solve() {
    if (!fields_.empty()) return;
    if (!is_variational()) return run_baseline();
    if (chooses_model()) return partition();
    Lattice<Dim> lattice(grid_.size, grid_.spacing, centers());
    result_ = descend(lattice);
    if (may_be_speckle(used_) && !options_.force) place_in_speckle(lattice, [](const auto&) { return true; });
    if (follows_law(options_, grid_.voxels()) && !report_.speckle && !is_enough()) return partition_by_law(lattice);
    write_fields(lattice);
  }

  // The labels within the mask, and the report.
  Segmentation<Dim> finish() {
    std::vector<std::uint8_t>& labels = result_.labels;
    for (std::size_t i = 0; i < options_.mask.size(); ++i)
      if (options_.mask[i] == 0) labels[i] = 0;
    SegmentReport found = std::move(report_);
    found.iterations = result_.iterations;
    found.converged = result_.converged;
    found.energy = std::move(result_.energy);
    found.regions = measure_regions(labels, given_values(), grid_, options_.mask, options_.regions);
    found.components = count_components(labels, grid_);
    found.noise = noise_.size;
    found.prices = price_list(prices_);
    warn_of_empty(found.regions, found.warnings);
    if (gain_ && *gain_ < 0) found.warnings.emplace_back(nothing_found);
    found.options = std::move(used_);
    return {std::move(labels), std::move(fields_), std::move(found)};
  }

 private:
  [[nodiscard]] bool is_local() const { return used_.mode == SegmentMode::local; }
  [[nodiscard]] bool is_variational() const { return options_.method == SegmentMethod::variational; }
  [[nodiscard]] bool chooses_model() const { return used_.energy == SegmentEnergy::automatic; }

  [[nodiscard]] LatticeOptions centers() const { return {*used_.center_spacing, *used_.support, used_.kernel}; }
  ForceSource& source() { return caller_ ? static_cast<ForceSource&>(*caller_) : *regions_; }

  // Two means where voxels say clearly to which they belong; false where they do not.
  bool partition_large() {
    SlicesInMemory image(values_, grid_.size[0] * grid_.size[1]);
    std::vector<std::uint8_t> labels(values_.size());
    std::optional<LargePartition<Dim>> found = find_large_partition<Dim>(
        image, grid_, options_.mask, large_options(grid_, used_, options_.progress), labels, {});
    if (!found) return false;
    std::vector<std::vector<float>> coefficients{std::move(found->coefficients)};
    result_ = {std::move(coefficients), std::move(labels), found->iterations, found->converged,
               std::move(found->energy)};
    choose_polarity_of_large(grid_, options_, result_);
    use_large(*found, used_);
    noise_.size = found->noise;
    fields_ = level_set_fields(found->lattice, result_.coefficients, found->blocks);
    return true;
  }

  [[nodiscard]] std::span<const float> given_values() const {
    return repaired_.empty() ? std::span<const float>(image_.values) : repaired_;
  }

  [[nodiscard]] PartitionPrice price_of(std::span<const float> values) const {
    return partition_price(values, given_values(), grid_, options_.mask);
  }

  Partition find_labels(std::span<const float> values, std::optional<PartitionPrice>& price,
                        const std::optional<PartitionModel>& model = {}, std::span<const std::uint8_t> start = {}) {
    price.emplace(price_of(values));
    return find_by(*price, model, start);
  }

  Partition find_by(PartitionPrice& price, const std::optional<PartitionModel>& model,
                    std::span<const std::uint8_t> start) {
    price.set_seeds(seeds_);
    return find_grained_partition(price, {options_.regions, shape_of(used_.shading), model, start, options_.progress});
  }

  // Once more by what the noise is at each place and intensity.
  void calm(Partition& found, std::optional<PartitionPrice>& price) {
    const auto find = [&](PartitionPrice& of, const std::optional<PartitionModel>& model,
                          std::span<const std::uint8_t> start) { return find_by(of, model, start); };
    FollowedNoise noise =
        follow_noise(values_, found, price, {[&](std::span<const float> values) { return price_of(values); }, find});
    report_.uneven_noise = noise.uneven_noise;
    report_.noise_growth = noise.noise_growth;
    if (noise.values.empty()) return;
    even_ = std::move(noise.values);
    values_ = even_;
    regions_.emplace(values_, grid_, options_.mask, law_of(options_.energy), options_.regions, prior_);
  }

  // The shortest description of the image by regions, then their contours in CSRBFs.
  void partition() {
    std::optional<PartitionPrice> price;
    Partition found = find_labels(values_, price);
    require(!found.labels.empty(), "segment", "voxels", price->voxels(),
            "must be at least three in each region; give an energy");
    if (options_.shading == Shading::automatic) prefer_sharp_labels(*price, found, options_.progress);
    calm(found, price);
    std::optional<TexturePartition> textures = find_textures(found);
    if (textures) {
      found = std::move(textures->partition);
      price.emplace(price_of(values_));
    }
    if (options_.regions == 2 && options_.seeds.empty()) gain_ = found.gain;
    blur_tissues(found, *price);
    const bool alike = warn_of_alike(divide_by_seeds(*price, seeds_, options_.regions, found), report_.warnings);
    const bool given = used_.center_spacing.has_value();
    const LatticeOptions centers{used_.center_spacing.value_or(1), *used_.support, used_.kernel};
    constexpr double tolerance = 0.1;  // of the contour's price; by hand: less follows noise, more is too smooth
    const double most = options_.regions > 2 ? 0
                                             : fit_blurred(*price, found.labels, found.model).price +
                                                   tolerance * contour_of(found.labels, *price);
    PartitionContours<Dim> contours = textures
                                          ? texture_contours<Dim>(*price, found, textures->force, centers, given)
                                          : partition_contours<Dim>(*price, found, options_.regions, centers, given);
    take(found, contours, *price);
    auto smooth = given || alike || found.in_blur ? std::nullopt : smooth_contour(*price, found.model, most);
    Lattice<Dim> lattice = smooth ? std::move(*smooth) : std::move(contours.lattice);
    if (Dim == 3 && options_.regions == 2 && !textures && found.model.shape <= MeanShape::quadratic)
      place_contour_level(*price, found.model, lattice, result_);
    // For means of echoes, which favour the brighter side of a border, the contour of echoes is dearer by its price.
    if (price->grain() > 1 && !found.model.own_deviations)
      place_in_speckle(lattice, [&](std::span<const std::uint8_t> labels) {
        return fit_blurred(*price, labels, found.model).price <=
               fit_blurred(*price, result_.labels, found.model).price + contour_of(result_.labels, *price);
      });
    const std::uint8_t first = result_.labels.front();
    if (options_.seeds.empty()) choose_polarity(grid_, options_, values_, result_);
    if (textures && result_.labels.front() != first) std::swap(textures->predicted[0], textures->predicted[1]);
    if (textures) report_.textures = textures->predicted;
    if (!textures && gain_ && *gain_ >= 0)
      warn_of_levels(given_values(), result_.labels, grid_, options_.mask, {price->weight(), price->grain()},
                     report_.warnings);
    used_.energy = energy_of(found.model);
    used_.shading = shading_of(found.model.shape);
    prices_ = std::move(found.prices);
    write_fields(lattice);
  }

  [[nodiscard]] double contour_of(std::span<const std::uint8_t> labels, const PartitionPrice& price) const {
    return contour_price(labels, 1, grid_.size, price.weight());
  }

  void take(Partition& found, PartitionContours<Dim>& contours, const PartitionPrice& price) {
    used_.center_spacing = contours.spacing;
    if (options_.regions == 2) used_.smoothness = contour_length / contours.force;
    if (price.grain() > 1) report_.grain = price.grain();
    result_ = {std::move(contours.coefficients), std::move(found.labels), found.iterations, found.converged,
               std::move(found.energy)};
    for (double& energy : result_.energy) energy /= price.voxels();
  }

  void write_fields(const Lattice<Dim>& lattice) {
    if (!is_local()) correct_labels(lattice, grid_, options_, result_.labels, result_.coefficients);
    fields_ = level_set_fields(lattice, result_.coefficients, grid_);
    keep_certain_seeds(seeds_, result_.labels);  // the lattice may leave out those of a voxel or two
  }

  bool is_enough() {
    if (used_.energy != SegmentEnergy::chan_vese) return false;
    PartitionPrice price = price_of(values_);
    return !loses_parts(price, model_of_law(used_).shape, result_.labels, regions_->start());
  }

  // The contours of least price by the law given. Those of the lattice, which smooths them, are among the starts.
  void partition_by_law(const Lattice<Dim>& lattice) {
    values_ = even_ = nearly_normal(values_, options_.mask, used_.energy);
    std::optional<PartitionPrice> price;
    const PartitionModel model = model_of_law(used_);
    Partition found = find_labels(values_, price, PartitionModel{model.shape}, result_.labels);
    if (model.own_deviations) {
      Partition other = find_labels(values_, price, model, result_.labels);
      found = better_by_law(*price, model, std::move(other), std::move(found));
    }
    if (found.labels.empty()) return write_fields(lattice);  // too few voxels for two regions
    if (options_.seeds.empty()) gain_ = found.gain;
    auto contours = partition_contours<Dim>(*price, found, 2, centers(), options_.center_spacing.has_value());
    take(found, contours, *price);
    if (options_.seeds.empty()) choose_polarity(grid_, options_, given_values(), result_);
    write_fields(contours.lattice);
  }

  // Two regions by what neighbours have in common, where intensities tell hardly anything.
  std::optional<TexturePartition> find_textures(const Partition& found) const {
    if (options_.regions > 2 || !options_.seeds.empty() || options_.shading != Shading::automatic) return std::nullopt;
    PartitionPrice price = price_of(values_);
    return find_texture_partition(price, found);
  }

  // More than two regions that are no areas between short contours, or two whose contours cost more than they tell.
  void blur_tissues(Partition& found, const PartitionPrice& price) {
    const bool two = options_.regions == 2, dear = !two || (found.gain < 0 && price.grain() == 1);
    if (!dear || !options_.seeds.empty() || (!two && found.model.own_deviations)) return;
    std::optional<PartitionPrice> other;
    std::optional<BlurredClasses> blurred =
        blurred_classes(values_, grid_, options_.mask, options_.regions, found, [&](std::span<const float> values) {
          return found.model == PartitionModel() ? find_labels(values, other).labels
                                                 : find_labels(values, other, found.model, found.labels).labels;
        });
    if (!blurred) return;
    found.labels = std::move(blurred->labels);
    found.model = {two ? blurred->light : std::min(blurred->light, MeanShape::quadratic)};
    report_.blur = blurred->deviation;
    if (!used_.center_spacing) used_.center_spacing = 1;
  }

  // Descends from the contour of a partition, which follows the noise, on centres as far apart as the noise asks for.
  // Kept where its labels cost at most that and lie where the image says.
  std::optional<Lattice<Dim>> smooth_contour(PartitionPrice& price, const PartitionModel& model, double most) {
    if (options_.regions > 2 || model.own_deviations || model.shape > MeanShape::quadratic) return std::nullopt;
    regions_->set_shading_degree(static_cast<int>(model.shape));
    regions_->fit(result_.labels);
    const ForceNoise noise = force_noise(*regions_, result_.labels, options_.mask, grid_);
    const double half = 0.5 * static_cast<double>(*std::max_element(grid_.size.begin(), grid_.size.end()));
    const double spacing = std::min(choose_center_spacing(noise, Dim), std::max(1.0, half));
    Lattice<Dim> lattice(grid_.size, grid_.spacing, {spacing, *used_.support, used_.kernel});
    VariationalResult found =
        descend_globally(lattice, *regions_, {0, noise.size, used_.iterations, false, {}}, result_.labels);
    if (fit_blurred(price, found.labels, model).price > most) return std::nullopt;
    if (Dim == 3 && std::abs(place_contour_level(price, model, lattice, found)) > level_tolerance) return std::nullopt;
    used_.center_spacing = spacing;
    result_.labels = std::move(found.labels);
    result_.coefficients = std::move(found.coefficients);
    return lattice;
  }

  // The methods that the variational one is compared with.
  void run_baseline() {
    result_.labels = std::move(labels_);
    if (options_.seed.empty()) choose_polarity(grid_, options_, values_, result_);
    BaselineResult<Dim> found = follow_baseline<Dim>(grid_, used_, options_.progress, source(), result_.labels);
    fields_.push_back(found.field);
    result_ = {{}, std::move(found.labels), found.iterations, found.converged, std::move(found.energy)};
  }

  // The variational method: on edges, locally or globally.
  VariationalResult descend(const Lattice<Dim>& lattice) {
    if (used_.energy == SegmentEnergy::edge && !options_.force)
      return descend_to_edges(lattice,
                              {*used_.smoothness, used_.balloon, options_.mask, used_.iterations, *used_.fill_holes,
                               options_.progress, options_.seeds},
                              grid_, edge_weights(values_, grid_), std::move(labels_));
    const VariationalOptions how{*used_.smoothness, noise_.size,   used_.iterations, *used_.fill_holes,
                                 options_.progress, options_.mask, options_.seeds};
    if (is_local() && (!options_.seed.empty() || !options_.start.empty()))
      return descend_locally(lattice, source(), how, grid_, std::move(labels_));
    VariationalResult found = descend_globally(lattice, source(), how, std::move(labels_));
    if (!is_local() && can_be_shaded(used_) && !options_.force) shade(lattice, how, found);
    if (options_.seeds.empty()) choose_polarity(grid_, options_, values_, found);
    return is_local() ? descend_locally(lattice, source(), how, grid_, std::move(found.labels)) : std::move(found);
  }

  // Lets the means vary and goes on, if that is wanted or explains most of what constants leave.
  void shade(const Lattice<Dim>& lattice, const VariationalOptions& how, VariationalResult& found) {
    constexpr double clearly = 0.5;  // share of the variance that is worth a second descent; by hand
    if (used_.shading == Shading::automatic)
      used_.shading = regions_->shading_explains(found.labels) > clearly ? Shading::linear : Shading::none;
    if (used_.shading == Shading::none) return;
    regions_->set_shading_degree(used_.shading == Shading::linear ? 1 : 2);
    regions_->fit(found.labels);
    found = descend_globally(lattice, source(), how, std::move(found.labels));
  }

  // Where the image is speckle, places the contour where its blur says, if the labels are taken.
  void place_in_speckle(Lattice<Dim>& lattice, const std::function<bool(std::span<const std::uint8_t>)>& takes) {
    std::optional<SpecklePlace<Dim>> placed =
        find_speckle_place<Dim>(values_, grid_, options_.mask, prior_, centers(), options_.center_spacing.has_value(),
                                result_.labels, result_.coefficients[0]);
    if (!placed || !takes(placed->labels)) return;
    report_.speckle = placed->exponent;
    used_.center_spacing = placed->spacing;
    lattice = std::move(placed->lattice);
    result_.coefficients[0] = std::move(placed->coefficients);
    result_.labels = std::move(placed->labels);
    // The laws differ by a constant.
    const std::vector<double>& steps = placed->steps;
    for (std::size_t i = 1; i < steps.size(); ++i)
      result_.energy.push_back(result_.energy.back() + (steps[i] - steps[i - 1]) / static_cast<double>(values_.size()));
  }

  const Volume<float>& image_;
  const SegmentOptions& options_;
  const Grid& grid_;
  SegmentSettings used_;
  std::vector<float> repaired_;  // the values when some are not finite
  std::vector<float> even_;      // the values when the noise grows with them
  std::span<const float> values_;
  SeedCosts seeds_;
  std::vector<float> prior_;
  std::optional<RegionForces<Dim>> regions_;
  std::optional<CallerForces> caller_;
  std::vector<std::uint8_t> given_;  // labels of the caller to start from
  std::vector<std::uint8_t> labels_;
  ForceNoise noise_;
  VariationalResult result_;
  std::vector<std::shared_ptr<const Field<Dim>>> fields_;
  std::optional<double> gain_;
  SegmentReport report_;  // what only some images have
  std::vector<ModelPrice> prices_;
};

}  // namespace

template <int Dim>
Segmentation<Dim> segment_known(const Volume<float>& image, const SegmentOptions& options) {
  Segmenter<Dim> segmenter(image, options);
  segmenter.start();
  segmenter.measure();
  segmenter.solve();
  return segmenter.finish();
}

template Segmentation<2> segment_known<2>(const Volume<float>&, const SegmentOptions&);
template Segmentation<3> segment_known<3>(const Volume<float>&, const SegmentOptions&);

}  // namespace csrbf
