#include "csrbf/levelset/compare_labels.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/interruption.hpp"
#include "csrbf/core/percentile.hpp"
#include "csrbf/spatial/distance_transform.hpp"

#include <Eigen/Geometry>

#include <map>

namespace csrbf {
namespace {

constexpr std::size_t most_labels = 4096;  // with more, grey values were taken for labels; by hand

using Labels = std::vector<std::int32_t>;
using Voxel = std::array<Index, 3>;

void check_same_place(const Grid& a, const Grid& b) {
  require(a.size == b.size, "compare_labels", "size of the images", size_text(a) + " and " + size_text(b),
          "must be the same; resample one of them");
  const double apart = distance_apart(a, b);
  require(apart == 0, "compare_labels", "distance of the same voxel in both images", apart,
          "must be 0; " + places_text(a, b) + ": resample one of the images");
}

constexpr unsigned pause_after = 1U << 16;  // voxels

Labels whole_numbers(const Volume<float>& volume, const char* which, bool inside_only) {
  require(volume.components == 1 && volume.frames == 1, "compare_labels",
          std::string("components and frames of the ") + which,
          std::to_string(volume.components) + " and " + std::to_string(volume.frames), "a voxel must have one label");
  constexpr float exact = 1 << 24;  // floats hold all whole numbers up to here
  Labels labels(volume.values.size());
  InterruptionPoint pause(pause_after);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    pause();
    const float value = volume.values[i];
    if (!(value == std::floor(value) && std::abs(value) <= exact))
      require(false, "compare_labels", std::string("value in the ") + which, value,
              "labels are whole numbers; segment or round the image first");
    labels[i] = inside_only && value != 0 ? 1 : static_cast<std::int32_t>(value);
  }
  return labels;
}

// What is counted of one label.
struct Extent {
  Index voxels = 0, reference_voxels = 0, common = 0;
  Voxel begin{std::numeric_limits<Index>::max(), std::numeric_limits<Index>::max(), std::numeric_limits<Index>::max()};
  Voxel end{0, 0, 0};

  void add(const Voxel& v) {
    for (std::size_t a = 0; a < 3; ++a) {
      begin[a] = std::min(begin[a], v[a]);
      end[a] = std::max(end[a], v[a] + 1);
    }
  }
};

std::map<std::int32_t, Extent> extents(const Voxel& size, const Labels& a, const Labels& b) {
  std::map<std::int32_t, Extent> found;
  InterruptionPoint pause(pause_after);
  std::size_t i = 0;
  for (Index z = 0; z < size[2]; ++z)
    for (Index y = 0; y < size[1]; ++y)
      for (Index x = 0; x < size[0]; ++x, ++i) {
        pause();
        if (a[i] == 0 && b[i] == 0) continue;
        for (const std::int32_t label : {a[i], b[i]})
          if (label != 0) found[label].add({x, y, z});
        if (a[i] != 0) ++found[a[i]].voxels;
        if (b[i] != 0) ++found[b[i]].reference_voxels;
        if (a[i] == b[i]) ++found[a[i]].common;
        require(found.size() <= most_labels, "compare_labels", "labels", found.size(),
                "there may be 4096 at most; is one of the images no label image?");
      }
  return found;
}

// Marks the border voxels of a label within its box.
std::vector<std::uint8_t> border(const Voxel& size, const Labels& labels, std::int32_t label, const Extent& box) {
  std::vector<std::uint8_t> marked;
  marked.reserve((box.end[0] - box.begin[0]) * (box.end[1] - box.begin[1]) * (box.end[2] - box.begin[2]));
  const std::array<Index, 3> stride{1, size[0], size[0] * size[1]};
  const auto is_border = [&](const Voxel& v, Index i) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (size[a] == 1) continue;
      if (v[a] == 0 || v[a] + 1 == size[a]) return true;
      if (labels[i - stride[a]] != label) return true;
      if (labels[i + stride[a]] != label) return true;
    }
    return false;
  };
  InterruptionPoint pause(pause_after);
  for (Index z = box.begin[2]; z < box.end[2]; ++z)
    for (Index y = box.begin[1]; y < box.end[1]; ++y)
      for (Index x = box.begin[0]; x < box.end[0]; ++x) {
        pause();
        const Index i = x + size[0] * (y + size[1] * z);
        marked.push_back(labels[i] == label && is_border({x, y, z}, i) ? 1 : 0);
      }
  return marked;
}

double distance95(const std::vector<std::uint8_t>& from, const std::vector<float>& distance) {
  constexpr double fraction = 0.95;  // conventional: HD95
  std::vector<float> distances;
  InterruptionPoint pause(pause_after);
  for (std::size_t i = 0; i < from.size(); ++i) {
    pause();
    if (from[i] != 0) distances.push_back(distance[i]);
  }
  return static_cast<double>(percentile(distances, fraction));
}

double hausdorff95(const Grid& grid, const Labels& a, const Labels& b, std::int32_t label, const Extent& box) {
  if (box.voxels == 0 || box.reference_voxels == 0) return std::numeric_limits<double>::infinity();
  const Voxel size{box.end[0] - box.begin[0], box.end[1] - box.begin[1], box.end[2] - box.begin[2]};
  const auto of_a = border(grid.size, a, label, box), of_b = border(grid.size, b, label, box);
  return std::max(distance95(of_a, distance_transform(size, grid.spacing, of_b)),
                  distance95(of_b, distance_transform(size, grid.spacing, of_a)));
}

void overlap(Index voxels, Index reference_voxels, Index common, LabelAgreement& agreement) {
  const auto sum = static_cast<double>(voxels + reference_voxels), shared = static_cast<double>(common);
  if (sum == 0) return;
  agreement.dice = 2 * shared / sum;
  agreement.jaccard = shared / (sum - shared);
}

}  // namespace

LabelsComparison compare_labels(const Volume<float>& labels, const Volume<float>& reference,
                                const CompareLabelsOptions& options) {
  check_same_place(labels.grid, reference.grid);
  report(options.progress, "compare", 0);
  const Labels a = whole_numbers(labels, "image", options.inside_only);
  const Labels b = whole_numbers(reference, "reference", options.inside_only);
  const auto found = extents(labels.grid.size, a, b);
  LabelsComparison result;
  Index voxels = 0, reference_voxels = 0, common = 0;
  for (const auto& [label, extent] : found) {
    report(options.progress, "compare", static_cast<double>(result.labels.size()) / static_cast<double>(found.size()));
    LabelComparison one;
    one.label = label;
    one.voxels = extent.voxels;
    one.reference_voxels = extent.reference_voxels;
    overlap(extent.voxels, extent.reference_voxels, extent.common, one);
    one.hausdorff95 = hausdorff95(labels.grid, a, b, label, extent);
    result.hausdorff95 = std::max(result.hausdorff95, one.hausdorff95);
    voxels += extent.voxels;
    reference_voxels += extent.reference_voxels;
    common += extent.common;
    result.labels.push_back(one);
  }
  overlap(voxels, reference_voxels, common, result);
  report(options.progress, "compare", 1);
  return result;
}

}  // namespace csrbf
