#include "csrbf/implicit/render/render_tile.hpp"

#include "csrbf/core/interruption.hpp"
#include "csrbf/implicit/mesh/triangle_geometry.hpp"

namespace csrbf {
namespace {

// Chosen by hand.
constexpr double lamp_radius = 0.14;  // of the key light over its distance, 16 degrees across; larger: softer shadows
constexpr float cos_same_surface = 0.8F;     // neighbours share light if their normals differ by up to 37 degrees ...
constexpr double same_surface_pixels = 1.5;  // ... and they lie in the same plane up to this number of pixels

enum class Seen : unsigned char { background, surface, ground };

// One ray of the picture and what it met.
struct Sample {
  Seen seen = Seen::background;
  double pixel = 0;  // size of a pixel at this distance
  Point<3> position = Point<3>::Zero();
  Point<3> shadow_origin = Point<3>::Zero();
  Point<3> normal = Point<3>::Zero();  // for shading, towards the viewer
  std::array<Point<3>, 2> tangent{Point<3>::Zero(), Point<3>::Zero()};
  Point<3> facet = Point<3>::Zero();
  Point<3> to_viewer = Point<3>::Zero();
  LinearRgb color = LinearRgb::Zero();
};

// The light at a sample, and the data that decide whether a neighbour may share it. Small, because it is read 64 times.
struct Light {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // from the centre of the box, in its diagonals
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  ReceivedLight received;
  Seen seen = Seen::background;
};

// Whether a sample may share the light of `center`. Branchless: the answer is unpredictable.
bool on_same_surface(const Light& light, const Light& center, float thickness) {
  const float off_plane = std::abs((light.position - center.position).dot(center.normal));
  const bool parallel = light.normal.dot(center.normal) >= cos_same_surface;
  return (light.seen == center.seen) & (off_plane <= thickness) & parallel;
}

// The samples of a tile and of the border needed to average the light.
class TileSamples {
 public:
  TileSamples(const Studio& studio, const Tile& tile)
      : studio_(studio),
        tile_(tile),
        per_side_(studio.options.samples),
        x_begin_(tile.x_begin * per_side_ - before),
        y_begin_(tile.y_begin * per_side_ - before),
        columns_((tile.x_end - tile.x_begin) * per_side_ + before + after),
        rows_((tile.y_end - tile.y_begin) * per_side_ + before + after),
        samples_(Index{columns_} * rows_),
        lights_(samples_.size()) {}

  void cast() {
    std::vector<Ray> rays(samples_.size());
    std::vector<SurfaceHit> hits(samples_.size());
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) rays[index(column, row)] = ray_at(column, row);
    stop_if_interrupted();
    studio_.scene.trace(rays, hits);
    stop_if_interrupted();
    const double diagonal = studio_.box.diagonal();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      samples_[i] = sample_of(rays[i], hits[i]);
      lights_[i].seen = samples_[i].seen;
      lights_[i].position = ((samples_[i].position - studio_.box.center()) / diagonal).cast<float>();
      lights_[i].normal = samples_[i].normal.cast<float>();
    }
  }

  // Samples of one class send their rays in almost the same direction where the surface is smooth. Tracing them
  // consecutively keeps most of the part of the triangle tree they need in the cache.
  void gather_light() {
    if (studio_.pattern.rays_per_sample() == 0 || studio_.color.unlit()) return;
    for (int first_row = 0; first_row < LightPattern::side; ++first_row)
      for (int first_column = 0; first_column < LightPattern::side; ++first_column) {
        stop_if_interrupted();
        gather_class(first_column, first_row);
      }
  }

  void resolve(RgbImage& image) const {
    for (int y = tile_.y_begin; y < tile_.y_end; ++y) {
      for (int x = tile_.x_begin; x < tile_.x_end; ++x) {
        const Eigen::Vector3f color =
            pixel_color((x - tile_.x_begin) * per_side_ + before, (y - tile_.y_begin) * per_side_ + before);
        const Index first = 3 * (Index{y} * image.width + x);
        for (Index k = 0; k < 3; ++k) image.pixels[first + k] = static_cast<std::uint8_t>(std::lround(255 * color[k]));
      }
    }
  }

 private:
  // The average of the light runs over a square of LightPattern::side samples, from `before` to `after`.
  static constexpr int before = LightPattern::side / 2;
  static constexpr int after = LightPattern::side - before - 1;

  [[nodiscard]] Index index(int column, int row) const { return Index{row} * columns_ + column; }
  [[nodiscard]] float thickness_at(std::size_t i) const {
    return static_cast<float>(same_surface_pixels * samples_[i].pixel / studio_.box.diagonal());
  }

  // The samples of a pixel form a sheared regular grid, so that nearly horizontal and vertical edges are smoothed best.
  Ray ray_at(int column, int row) const {
    const int s = per_side_;
    const int x = x_begin_ + column, y = y_begin_ + row;
    const int i = ((x % s) + s) % s, j = ((y % s) + s) % s;
    return studio_.camera.ray((x + (j + 0.5) / s) / s, (y + (s - i - 0.5) / s) / s);
  }

  Sample sample_of(const Ray& ray, const SurfaceHit& hit) const {
    Sample sample;
    sample.to_viewer = -ray.direction;
    if (hit.exists()) {
      sample.seen = Seen::surface;
      sample.position = hit.position;
      sample.shadow_origin = hit.shadow_origin;
      sample.normal = hit.inside ? Point<3>(-hit.normal) : hit.normal;
      sample.tangent = tangents(sample.normal);
      sample.facet = hit.facet;
      sample.color = studio_.color(hit);
      if (hit.inside && !studio_.color.unlit())
        sample.color = sample.color.cwiseProduct(LinearRgb(0.55F, 0.62F, 0.72F));
      sample.pixel = studio_.camera.pixel_at(hit.t);
      return sample;
    }
    const double t = (studio_.ground_level - ray.origin.dot(studio_.up)) / ray.direction.dot(studio_.up);
    if (!(ray.direction.dot(studio_.up) < 0) || !(t > 0) || !std::isfinite(t)) return sample;
    sample.seen = Seen::ground;
    sample.position = ray.origin + t * ray.direction;
    sample.normal = sample.facet = studio_.up;
    sample.tangent = tangents(studio_.up);
    sample.shadow_origin = sample.position + 1e-6 * studio_.reach * studio_.up;
    sample.pixel = studio_.camera.pixel_at(t);
    return sample;
  }

  bool sky_is_hidden(const Sample& sample, const LightPattern::SkyRay& sky) const {
    const Point<3>& s = sky.direction;
    Point<3> d = s[0] * sample.tangent[0] + s[1] * sample.tangent[1] + s[2] * sample.normal;
    const double above = d.dot(sample.facet);
    if (above < 0) d -= 2 * above * sample.facet;
    return studio_.scene.occluded({sample.shadow_origin, d}, sky.reach * studio_.reach);
  }

  bool lamp_is_hidden(const Sample& sample, const Point<2>& lamp) const {
    const auto [t1, t2] = tangents(studio_.key_light);
    const Point<3> d = (studio_.key_light + lamp_radius * (lamp[0] * t1 + lamp[1] * t2)).normalized();
    if (d.dot(sample.normal) <= 0 || d.dot(sample.facet) <= 0) return d.dot(sample.normal) <= 0;
    return studio_.scene.occluded({sample.shadow_origin, d}, std::numeric_limits<double>::infinity());
  }

  void gather_class(int first_column, int first_row) {
    const int rays = studio_.pattern.rays_per_sample();
    const int light_class = LightPattern::class_of(x_begin_ + first_column, y_begin_ + first_row);
    const Box<3> near_surface = studio_.box.inflated(studio_.reach);
    const auto for_each = [&](auto&& action) {
      for (int row = first_row; row < rows_; row += LightPattern::side) {
        for (int column = first_column; column < columns_; column += LightPattern::side) {
          const std::size_t i = index(column, row);
          if (samples_[i].seen != Seen::background) action(samples_[i], lights_[i]);
        }
      }
    };
    for_each([&](const Sample& sample, Light& light) {
      light.received.lit = lamp_is_hidden(sample, studio_.pattern.lamp(light_class)) ? 0.0F : 1.0F;
    });
    for (int ray = 0; ray < rays; ++ray) {
      for_each([&](const Sample& sample, Light& light) {
        const bool on_ground = sample.seen == Seen::ground;
        const LightPattern& pattern = on_ground ? studio_.ground_pattern : studio_.pattern;
        const int sent = pattern.rays_per_sample();
        if (ray >= sent || (on_ground && !near_surface.contains(sample.position))) return;
        if (sky_is_hidden(sample, pattern.sky(light_class, ray)))
          light.received.open -= 1.0F / static_cast<float>(sent);
      });
    }
  }

  // Average over the neighbours on the same surface.
  ReceivedLight average_light(int column, int row) const {
    const Light& center = lights_[index(column, row)];
    const float thickness = thickness_at(index(column, row));
    float open = 0, lit = 0, count = 0;
    for (int j = row - before; j <= row + after; ++j) {
      const Light* line = lights_.data() + index(column - before, j);
      for (const Light& light : std::span(line, LightPattern::side)) {
        const float weight = on_same_surface(light, center, thickness) ? 1.0F : 0.0F;
        open += weight * light.received.open;
        lit += weight * light.received.lit;
        count += weight;
      }
    }
    return {open / count, lit / count};
  }

  // Mean of the samples in display values: edges against a white background look smoother than with the mean of linear
  // light.
  Eigen::Vector3f pixel_color(int column, int row) const {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    std::size_t averaged = samples_.size();
    ReceivedLight average;
    for (int j = row; j < row + per_side_; ++j) {
      for (int i = column; i < column + per_side_; ++i) {
        const std::size_t k = index(i, j);
        const Sample& sample = samples_[k];
        if (sample.seen == Seen::background) {
          sum += studio_.background;
          continue;
        }
        // Samples of a pixel on the same surface have almost the same neighbours: one average serves them all.
        if (averaged == samples_.size() || !on_same_surface(lights_[k], lights_[averaged], thickness_at(averaged))) {
          average = average_light(i, j);
          averaged = k;
        }
        sum += sample.seen == Seen::ground
                   ? studio_.ground_color(average)
                   : studio_.surface_color(sample.color, sample.normal, sample.to_viewer, average);
      }
    }
    return sum / static_cast<float>(per_side_ * per_side_);
  }

  const Studio& studio_;
  const Tile& tile_;
  int per_side_;
  int x_begin_, y_begin_;  // of the samples, in samples from the corner of the picture; may be negative
  int columns_, rows_;
  std::vector<Sample> samples_;
  std::vector<Light> lights_;
};

}  // namespace

void render_tile(const Studio& studio, const Tile& tile, RgbImage& image) {
  TileSamples samples(studio, tile);
  samples.cast();
  samples.gather_light();
  samples.resolve(image);
}

}  // namespace csrbf
