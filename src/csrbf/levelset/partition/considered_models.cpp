#include "csrbf/levelset/partition/considered_models.hpp"

#include "csrbf/levelset/image/common_background.hpp"

namespace csrbf {
namespace {

// Smooth means over less follow blurred objects, not light; by hand.
constexpr Index least_reach = 8;  // voxels

// Those of half the usual reach follow light that varies faster.
std::vector<double> reaches_of_smooth_means(const Grid& grid) {
  const std::array<Index, 3> half = LocalMean(grid, 0.5 * smooth_reach).half_width;
  if (*std::max_element(half.begin(), half.end()) < least_reach) return {smooth_reach};
  return {smooth_reach, 0.5 * smooth_reach};
}

}  // namespace

std::vector<PartitionModel> considered_models(const PartitionPrice& price, const PartitionOptions& options, bool few) {
  if (options.model) return {*options.model};
  std::vector<PartitionModel> models;
  const bool two = options.regions == 2, shaped = two && !price.is_certainty_given();
  const auto wanted = [&](MeanShape shape) { return !options.shape || *options.shape == shape; };
  if (wanted(MeanShape::constant) || few) models.emplace_back();
  if (few) return models;
  if (wanted(MeanShape::constant) && two) models.push_back({MeanShape::constant, true});
  if (wanted(MeanShape::constant) && shaped) models.push_back({MeanShape::constant, true, true});
  for (const MeanShape shape : {MeanShape::linear, MeanShape::quadratic})
    if (wanted(shape)) models.push_back({shape});
  if (wanted(MeanShape::smooth) && two)
    for (const double reach : reaches_of_smooth_means(price.grid()))
      models.push_back({MeanShape::smooth, false, false, 1, reach});
  for (const MeanShape shape : {MeanShape::linear, MeanShape::quadratic})
    if (wanted(shape) && shaped) models.push_back({shape, false, true});
  if (models.empty() && !two) models.emplace_back();
  if (wanted(MeanShape::background) && two)
    for (const double factor : {1.0, 2.0, 4.0})
      models.push_back({MeanShape::background, false, false, 1, factor * closest_background});
  if (wanted(MeanShape::objects) && two)
    for (const std::uint8_t label : {std::uint8_t{1}, std::uint8_t{0}})
      models.push_back({MeanShape::objects, false, false, label});
  return models;
}

bool goes_on_from(const PartitionModel& model, const PartitionModel& simpler, bool is_followed) {
  const bool same_shape = simpler.shape == model.shape;
  if (model.shape == MeanShape::background) return same_shape && simpler.reach < model.reach && is_followed;
  if (model.shape == MeanShape::smooth)
    return simpler == PartitionModel{MeanShape::quadratic} ||
           (same_shape && simpler.reach > model.reach && is_followed);
  return model.shape != MeanShape::constant && model.own_shapes && simpler == PartitionModel{model.shape};
}

}  // namespace csrbf
