#include "csrbf/levelset/frame/image_frame.hpp"

#include "csrbf/levelset/frame/straight_edges.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/regions/label_runs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace csrbf {
namespace {

constexpr double long_part = 1.0 / 8;  // of a side, that lines have at least; by hand
constexpr double shortest = 12;        // faces
constexpr float lossy = 0.12F;         // of the range, that values beside a frame are off; by hand
constexpr double most_exact = 0.6;     // of a part that has exactly its value, at least; by hand
constexpr double least_frame = 5e-4;   // of the voxels; by hand: less harms nothing
constexpr Index least_rest = 100;      // voxels that may have regions; by hand

class FrameFinder {
 public:
  FrameFinder(const Volume<float>& image, std::span<const std::uint8_t> mask)
      : image_(image),
        grid_(image.grid),
        mask_(mask),
        components_(static_cast<std::size_t>(image.components)),
        outside_(static_cast<std::size_t>(image.grid.voxels()), 0) {}

  std::optional<ImageFrame> find() {
    double largest = 0;
    ImageFrame frame{{}, 0, 0, 0};
    for (const std::vector<float>& value : candidates()) {
      double count = mark(value, 0);
      if (count == 0) count = mark(value, lossy * range_);  // as JPEG leaves the edges of a frame
      if (count > 0) ++frame.values;
      if (count > largest) {
        largest = count;
        frame.value = value[0];
      }
    }
    double all = 0, in = 0;
    for (std::size_t i = 0; i < outside_.size(); ++i) {
      all += inside(i) ? 1 : 0;
      in += outside_[i];
    }
    if (in == 0 || in < least_frame * all || !stands_out(frame.value, in)) return std::nullopt;
    mark_mixed(frame.value);
    if (!may_have_regions()) return std::nullopt;
    frame.share = static_cast<double>(std::count(outside_.begin(), outside_.end(), 1)) / all;
    frame.outside = std::move(outside_);
    return frame;
  }

 private:
  [[nodiscard]] bool inside(std::size_t i) const { return mask_.empty() || mask_[i] != 0; }
  [[nodiscard]] std::span<const float> at(std::size_t i) const {
    return std::span(image_.values).subspan(i * components_, components_);
  }

  [[nodiscard]] bool is_near(std::size_t i, const std::vector<float>& value, float tolerance) const {
    for (std::size_t c = 0; c < components_; ++c)
      if (!(std::abs(at(i)[c] - value[c]) <= tolerance)) return false;
    return true;
  }

  // Things cut out of their picture, on a constant ground, leave nothing but their own value and that of blurred edges.
  [[nodiscard]] bool may_have_regions() const {
    std::vector<float> rest;
    for (std::size_t i = 0; i < outside_.size(); ++i)
      if (inside(i) && outside_[i] == 0 && !std::isnan(at(i)[0])) rest.push_back(at(i)[0]);
    if (std::ssize(rest) < least_rest) return false;
    std::sort(rest.begin(), rest.end());
    const std::size_t half = rest.size() / 2;
    for (std::size_t i = 0; i + half < rest.size(); ++i)
      if (rest[i] == rest[i + half]) return false;
    return true;
  }

  // Of the corners, and the least and the greatest ones.
  [[nodiscard]] std::set<std::vector<float>> candidates() {
    std::vector<float> least(components_, std::numeric_limits<float>::infinity()), greatest(components_, -least[0]);
    for (std::size_t i = 0; i < outside_.size(); ++i)
      for (std::size_t c = 0; c < components_ && inside(i); ++c) {
        const float x = at(i)[c];
        if (std::isnan(x)) continue;
        least[c] = std::min(least[c], x);
        greatest[c] = std::max(greatest[c], x);
      }
    greatest_ = greatest;
    for (std::size_t c = 0; c < components_; ++c) range_ = std::max(range_, greatest[c] - least[c]);
    std::set<std::vector<float>> values{least, greatest};
    for (const Index i : corners()) {
      const std::span<const float> corner = at(static_cast<std::size_t>(i));
      if (std::none_of(corner.begin(), corner.end(), [](float c) { return std::isnan(c); }))
        values.insert({corner.begin(), corner.end()});
    }
    return values;
  }

  [[nodiscard]] std::vector<Index> corners() const {
    std::vector<Index> found;
    for (const Index x : {Index{0}, grid_.size[0] - 1})
      for (const Index y : {Index{0}, grid_.size[1] - 1})
        for (const Index z : {Index{0}, grid_.size[2] - 1}) found.push_back(grid_.index(x, y, z));
    return found;
  }

  // Marks the parts that have this value and end as a frame does; returns how many voxels.
  double mark(const std::vector<float>& value, float tolerance) {
    std::vector<std::uint8_t> same(outside_.size());
    for (std::size_t i = 0; i < same.size(); ++i)
      same[i] = inside(i) && outside_[i] == 0 && is_near(i, value, tolerance) ? 1 : 0;
    if (tolerance > 0) smooth(same);
    LabelRuns runs(same, grid_);
    const LabelRuns::Parts parts = runs.parts(1);
    std::vector<bool> border(parts.count, false);
    std::vector<Index> sizes(parts.count, 0), exact(parts.count, 0);
    std::vector<std::int32_t> part(same.size(), -1);
    const auto [nx, ny, nz] = grid_.size;
    for (std::size_t row = 0; row + 1 < runs.first.size(); ++row)
      for (std::size_t r = runs.first[row]; r < runs.first[row + 1]; ++r) {
        const std::int32_t p = parts.of_run[r];
        if (p < 0) continue;
        const LabelRuns::Run& run = runs.runs[r];
        const Index y = static_cast<Index>(row) % ny, z = static_cast<Index>(row) / ny;
        if (run.begin == 0 || run.end == nx || (ny > 1 && (y == 0 || y + 1 == ny)) ||
            (nz > 1 && (z == 0 || z + 1 == nz)))
          border[p] = true;
        sizes[p] += run.end - run.begin;
        std::fill_n(part.begin() + static_cast<Index>(row) * nx + run.begin, run.end - run.begin, p);
      }
    for (std::size_t i = 0; i < part.size(); ++i)
      if (part[i] >= 0 && is_near(i, value, 0)) ++exact[part[i]];
    for (std::size_t p = 0; p < parts.count; ++p)
      if (static_cast<double>(exact[p]) < most_exact * static_cast<double>(sizes[p])) border[p] = false;
    std::vector<bool> has_corner(parts.count, false);
    for (const Index i : corners())
      if (part[static_cast<std::size_t>(i)] >= 0) has_corner[part[static_cast<std::size_t>(i)]] = true;
    std::vector<std::vector<Point<3>>> faces(parts.count);
    gather_faces(part, border, faces);
    std::vector<bool> frame = border;
    if (!is_round(parts_at(border, faces)))
      for (std::size_t p = 0; p < parts.count; ++p)
        frame[p] = border[p] && (has_corner[p] || value != greatest_) && !faces[p].empty() &&
                   are_straight(faces[p], least_faces());
    std::vector<bool> others(parts.count);
    for (std::size_t p = 0; p < parts.count; ++p) others[p] = border[p] && !frame[p];
    if (is_round(parts_at(others, faces))) frame = border;
    double count = 0;
    for (std::size_t i = 0; i < part.size(); ++i)
      if (part[i] >= 0 && frame[part[i]]) {
        outside_[i] = 1;
        count += 1;
      }
    return count;
  }

  static std::vector<Point<3>> parts_at(const std::vector<bool>& wanted,
                                        const std::vector<std::vector<Point<3>>>& faces) {
    std::vector<Point<3>> all;
    for (std::size_t p = 0; p < wanted.size(); ++p)
      if (wanted[p]) all.insert(all.end(), faces[p].begin(), faces[p].end());
    return all;
  }

  [[nodiscard]] bool is_round(const std::vector<Point<3>>& faces) const {
    return is_aperture(faces) || (grid_.dimension() == 2 && is_sector(faces, least_faces()));
  }

  // Takes what most voxels around have: ripples beside edges vanish, straight edges stay.
  void smooth(std::vector<std::uint8_t>& same) const {
    std::array<Index, 3> half{0, 0, 0};
    for (int a = 0; a < grid_.dimension(); ++a) half[static_cast<std::size_t>(a)] = 2;
    std::vector<float> share(same.begin(), same.end());
    box_mean(share, grid_.size, half);
    for (std::size_t i = 0; i < same.size(); ++i) same[i] = share[i] > 0.5F && outside_[i] == 0 && inside(i) ? 1 : 0;
  }

  // The middles of the faces between parts at the border and other voxels.
  void gather_faces(const std::vector<std::int32_t>& part, const std::vector<bool>& border,
                    std::vector<std::vector<Point<3>>>& faces) const {
    Index stride = 1;
    for (int a = 0; a < grid_.dimension(); ++a) {
      for (Index i = 0; i + stride < grid_.voxels(); ++i) {
        const Index at = i / stride % grid_.size[a];
        if (at + 1 == grid_.size[a] || part[i] == part[i + stride]) continue;
        if (!inside(static_cast<std::size_t>(i)) || !inside(static_cast<std::size_t>(i + stride))) continue;
        Point<3> middle(static_cast<double>(i % grid_.size[0]), static_cast<double>(i / grid_.size[0] % grid_.size[1]),
                        static_cast<double>(i / (grid_.size[0] * grid_.size[1])));
        middle[a] += 0.5;
        for (const std::int32_t p : {part[i], part[i + stride]})
          if (p >= 0 && border[p]) faces[p].push_back(middle);
      }
      stride *= grid_.size[a];
    }
  }

  // That a line or a plane has to have.
  [[nodiscard]] double least_faces() const {
    double shortest_side = 1e30;
    for (int a = 0; a < grid_.dimension(); ++a)
      shortest_side = std::min(shortest_side, static_cast<double>(grid_.size[a]));
    const double length = std::max(shortest, long_part * shortest_side);
    return grid_.dimension() == 3 ? length * length : length;
  }

  // Around the middle of the image, and about as wide; all along an axis of a volume.
  [[nodiscard]] bool is_aperture(const std::vector<Point<3>>& faces) const {
    constexpr double off = 0.08, narrowest = 0.35, widest = 0.75;  // of the shortest side; by hand
    if (static_cast<double>(faces.size()) < 4 * shortest) return false;
    for (int axis = 2; axis >= (grid_.dimension() == 3 ? 0 : 2); --axis) {
      const std::size_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
      const double nu = static_cast<double>(grid_.size[u]), nv = static_cast<double>(grid_.size[v]);
      const FittedCircle circle = fit_circle(faces, axis);
      const double side = std::min(nu, nv);
      if (circle.fits && circle.radius >= narrowest * side && circle.radius <= widest * std::max(nu, nv) &&
          std::hypot(circle.center[static_cast<Index>(u)] - 0.5 * (nu - 1),
                     circle.center[static_cast<Index>(v)] - 0.5 * (nv - 1)) <= off * side)
        return true;
    }
    return false;
  }

  // One that is thin and hardly differs from what is beside it harms nothing, and may be chance.
  [[nodiscard]] bool stands_out(float value, double voxels) const {
    constexpr double clearly = 1.8;  // deviations; values that begin at that of the frame are 1.73 from it
    constexpr double thick = 3;      // voxels; by hand
    double sum = 0, squares = 0, count = 0;
    const std::vector<std::uint8_t> first = beside(outside_);
    for (std::size_t i = 0; i < first.size(); ++i) {
      if (first[i] == 0 || std::isnan(at(i)[0])) continue;
      const double off = static_cast<double>(at(i)[0]) - static_cast<double>(value);
      sum += off;
      squares += off * off;
      count += 1;
    }
    return count > 0 && (voxels >= thick * count || sum * sum > clearly * clearly * (count * squares - sum * sum));
  }

  // Interpolation mixes values beside the frame with its own: they lie between it and those beyond.
  void mark_mixed(float value) {
    constexpr double clearly = 0.1;  // of the way to the frame, on average; by hand
    const std::vector<std::uint8_t> first = beside(outside_);
    std::vector<std::uint8_t> both = outside_;
    for (std::size_t i = 0; i < both.size(); ++i) both[i] |= first[i];
    const std::vector<std::uint8_t> second = beside(both);
    const double near = mean(first), beyond = mean(second), frame = static_cast<double>(value);
    const bool is_known = std::find(second.begin(), second.end(), 1) != second.end() && frame != beyond;
    if (is_known && (near - beyond) / (frame - beyond) > clearly) outside_ = std::move(both);
  }

  [[nodiscard]] double mean(const std::vector<std::uint8_t>& marked) const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (marked[i] == 0 || std::isnan(at(i)[0])) continue;
      sum += static_cast<double>(at(i)[0]);
      count += 1;
    }
    return sum / std::max(count, 1.0);
  }

  // Voxels in the mask that share a face with one that is marked.
  [[nodiscard]] std::vector<std::uint8_t> beside(const std::vector<std::uint8_t>& marked) const {
    std::vector<std::uint8_t> result(marked.size(), 0);
    Index stride = 1;
    for (int a = 0; a < grid_.dimension(); ++a) {
      for (Index i = 0; i + stride < grid_.voxels(); ++i) {
        if (i / stride % grid_.size[a] + 1 == grid_.size[a] || marked[i] == marked[i + stride]) continue;
        const auto other = static_cast<std::size_t>(marked[i] != 0 ? i + stride : i);
        if (inside(other)) result[other] = 1;
      }
      stride *= grid_.size[a];
    }
    return result;
  }

  const Volume<float>& image_;
  const Grid& grid_;
  std::span<const std::uint8_t> mask_;
  std::size_t components_;
  float range_ = 0;  // of the values
  std::vector<float> greatest_ = {};
  std::vector<std::uint8_t> outside_;
};

}  // namespace

bool is_drawing(std::span<const float> values) {
  constexpr std::size_t few = 16;  // by hand
  std::set<float> different;
  for (const float x : values) {
    if (!std::isnan(x)) different.insert(x);
    if (different.size() > few) return false;
  }
  return true;
}

std::optional<ImageFrame> find_image_frame(const Volume<float>& image, std::span<const std::uint8_t> mask) {
  if (is_drawing(image.values)) return std::nullopt;
  return FrameFinder(image, mask).find();
}

}  // namespace csrbf
