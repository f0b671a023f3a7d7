#include "csrbf/implicit/draw_contour.hpp"

namespace csrbf {
namespace {

// Share of each pixel covered by lines.
class Coverage {
 public:
  Coverage(int width, int height) : width_(width), height_(height), share_(Index{width} * height, 0) {}

  // The coverage of a pixel depends on the distance of its centre: the line fades out over the width of a pixel.
  void add_segment(const Point<2>& p, const Point<2>& q, double line_width) {
    const double reach = 0.5 * (line_width + 1);
    const Point<2> lo = p.cwiseMin(q).array() - reach, hi = p.cwiseMax(q).array() + reach;
    const int x0 = first(lo[0], width_), x1 = last(hi[0], width_), y0 = first(lo[1], height_),
              y1 = last(hi[1], height_);
    const Point<2> along = q - p;
    const double length2 = along.squaredNorm();
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const Point<2> from_p = Point<2>(x + 0.5, y + 0.5) - p;
        const double t = length2 > 0 ? std::clamp(from_p.dot(along) / length2, 0.0, 1.0) : 0;
        const auto covered = static_cast<float>(std::clamp(reach - (from_p - t * along).norm(), 0.0, 1.0));
        float& share = share_[Index{y} * width_ + x];
        share = std::max(share, covered);
      }
  }

  void blend(const RgbColor& color, RgbImage& picture) const {
    for (std::size_t i = 0; i < share_.size(); ++i)
      for (std::size_t c = 0; c < 3 && share_[i] > 0; ++c) {
        std::uint8_t& value = picture.pixels[3 * i + c];
        const auto old = static_cast<float>(value);
        value = static_cast<std::uint8_t>(std::lround(old + share_[i] * (static_cast<float>(color[c]) - old)));
      }
  }

 private:
  // The pixels whose centres are between two coordinates and in the picture.
  static int first(double lo, int size) { return static_cast<int>(std::clamp<double>(std::ceil(lo - 0.5), 0, size)); }
  static int last(double hi, int size) {
    return static_cast<int>(std::clamp<double>(std::floor(hi - 0.5), -1, size - 1));
  }

  int width_, height_;
  std::vector<float> share_;
};

}  // namespace

void draw_contour(const ContourLines& contours, const Stroke& stroke, RgbImage& picture) {
  require(stroke.width > 0 && std::isfinite(stroke.width), "draw_contour", "width", stroke.width,
          "must be a positive number of pixels");
  Coverage coverage(picture.width, picture.height);
  for (const ContourLine& line : contours.lines) {
    for (Index i = line.begin; i + 1 < line.begin + line.size; ++i)
      coverage.add_segment(contours.points.col(i), contours.points.col(i + 1), stroke.width);
    if (line.closed && line.size > 0)
      coverage.add_segment(contours.points.col(line.begin + line.size - 1), contours.points.col(line.begin),
                           stroke.width);
  }
  coverage.blend(stroke.color, picture);
}

}  // namespace csrbf
