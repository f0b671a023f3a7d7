#include "level_sets.hpp"

#include "csrbf/implicit/contour_lines.hpp"
#include "csrbf/implicit/preview.hpp"
#include "csrbf/implicit/render.hpp"
#include "csrbf/levelset/image/box_mean.hpp"
#include "csrbf/levelset/regions/energy_table.hpp"
#include "signals.hpp"

#include <algorithm>
#include <cmath>

namespace csrbf::thesis {
namespace {

class DiscField final : public Field<2> {
 public:
  DiscField(const Point<2>& center, double radius, const Box<2>& bounds)
      : center_(center), radius_(radius), bounds_(bounds) {}
  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) {
      const Point<2> away = x.col(i) - center_;
      out.value[i] = radius_ - away.norm();
      if (out.gradient != nullptr) Eigen::Map<Point<2>>(out.gradient + 2 * i) = -away.stableNormalized();
    }
  }
  [[nodiscard]] Box<2> bounds() const override { return bounds_; }
  [[nodiscard]] double feature_size() const override { return 0.1 * radius_; }

 private:
  Point<2> center_;
  double radius_;
  Box<2> bounds_;
};

// C1 and C2, eqs. (8.29) and (8.30) with a sharp u, and the energy.
struct TwoMeans {
  double inside = 0, outside = 0, energy = 0;
};

TwoMeans two_means(const std::vector<float>& values, const unsigned char* labels) {
  double count[2] = {0, 0}, sum[2] = {0, 0}, squares[2] = {0, 0};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<double>(values[i]);
    const std::size_t side = labels[i];
    ++count[side], sum[side] += value, squares[side] += value * value;
  }
  TwoMeans means;
  for (const std::size_t side : {0U, 1U}) {
    const double mean = count[side] > 0 ? sum[side] / count[side] : 0;
    (side == 1 ? means.inside : means.outside) = mean;
    means.energy += squares[side] - count[side] * mean * mean;
  }
  return means;
}

}  // namespace

std::vector<std::uint8_t> ball_labels(const Grid& grid, const Point<3>& center, double radius) {
  const Points<3> centers = grid.centers<3>();
  std::vector<std::uint8_t> labels(grid.voxels());
  for (Index i = 0; i < centers.cols(); ++i) labels[i] = (centers.col(i) - center).norm() < radius ? 1 : 0;
  return labels;
}

double dice(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double both = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] != 0 && b[i] != 0 ? 1 : 0;
    sum += (a[i] != 0 ? 1 : 0) + (b[i] != 0 ? 1 : 0);
  }
  return sum > 0 ? 2 * both / sum : 1;
}

ForceUpdate chan_vese_force(const Volume<float>& image, std::vector<double>* energy) {
  return [&values = image.values, energy](const unsigned char* labels, float* force) {
    const TwoMeans means = two_means(values, labels);
    if (energy != nullptr) energy->push_back(means.energy);
    const auto inside = static_cast<float>(means.inside), outside = static_cast<float>(means.outside);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float a = values[i] - inside, b = values[i] - outside;
      force[i] = a * a - b * b;
    }
  };
}

ForceUpdate generalized_gaussian_force(const Volume<float>& image, int half_window) {
  const IntensityBins bins = choose_bins(image.values);
  const std::array<Index, 3> window{half_window, half_window, image.grid.dimension() > 2 ? half_window : 0};
  return [bins, window, indices = bin_indices(image.values, bins), size = image.grid.size](const unsigned char* labels,
                                                                                           float* force) {
    const std::vector<Histogram> histograms = region_histograms(indices, {labels, indices.size()}, 2, bins);
    const auto energies = [&](std::size_t region) {
      return energy_table(fit_region_model(IntensityLaw::generalized_gaussian, histograms[region]), bins);
    };
    const std::vector<float> outside = energies(0);
    std::vector<float> difference = energies(1);
    std::transform(difference.begin(), difference.end(), outside.begin(), difference.begin(), std::minus<>());
    const std::span<float> out(force, indices.size());
    look_up_energies(indices, difference, out);
    box_mean(out, size, window);
  };
}

CollocationOptions published_options(double rho) {
  CollocationOptions options;
  options.support = rho;
  options.bound = LevelSetBound::l1_norm;
  return options;
}

SegmentedImage collocate_nodes(const Phantom& phantom, const Nodes<2>& nodes, const std::vector<std::uint8_t>& start,
                               const CollocationOptions& options, const ForceUpdate& force) {
  CollocationResult<2> result;
  const double time = seconds([&] {
    result =
        collocate<2>(phantom.image.grid, nodes, start.data(), force ? force : chan_vese_force(phantom.image), options);
  });
  const double overlap = dice(result.labels, phantom.truth);
  return {std::move(result.labels), std::move(result.field), overlap, result.iterations, time};
}

SegmentedImage segmented(const Phantom& phantom, const SegmentOptions& options) {
  Segmentation<2> result;
  const double time = seconds([&] { result = segment<2>(phantom.image, options); });
  const double overlap = dice(result.labels, phantom.truth);
  return {std::move(result.labels), result.fields[0], overlap, result.report.iterations, time};
}

double contour_length(const Field<2>& field) {
  return contour_lines(field, {.resolution = 512}).length;
}

std::shared_ptr<const Field<2>> disc_field(const Grid& grid, const Point<2>& center, double radius) {
  Box<2> box;
  box.add(Point<2>(-0.5, -0.5));
  box.add(Point<2>(static_cast<double>(grid.size[0]) - 0.5, static_cast<double>(grid.size[1]) - 0.5));
  return std::make_shared<const DiscField>(center, radius, box);
}

RgbImage drawn(const Volume<float>& image, const std::vector<const Field<2>*>& fields) {
  return preview<2>(image, fields, {.size = 400, .line_width = 3});
}

RgbImage relief(const Field<2>& field, double height) {
  constexpr Index n = 141;
  Box<2> box = field.bounds();
  // Beyond the last nodes, half a pixel from the border, f falls to 0.
  const Point<2> rim = 0.005 * box.extent();
  box.lo += rim;
  box.hi -= rim;
  const double scale = 0.3 * box.extent().maxCoeff() / height;
  Points<2> points(2, n * n);
  for (Index i = 0; i < points.cols(); ++i)
    points.col(i) =
        box.lo + box.extent().cwiseProduct(Point<2>(static_cast<double>(i % n), static_cast<double>(i / n)) /
                                           static_cast<double>(n - 1));
  const Eigen::VectorXd f = field.evaluate(points).value;
  Mesh mesh;
  mesh.vertices.resize(3, n * n);
  // Rows of images run downwards.
  mesh.vertices << points.row(0), -points.row(1), scale * f.transpose();
  mesh.triangles.resize(3, 2 * (n - 1) * (n - 1));
  Index t = 0;
  for (Index y = 0; y + 1 < n; ++y)
    for (Index x = 0; x + 1 < n; ++x) {
      const auto a = static_cast<std::int32_t>(x + n * y), below = static_cast<std::int32_t>(a + n);
      mesh.triangles.col(t++) << a, below, a + 1;
      mesh.triangles.col(t++) << a + 1, below, below + 1;
    }
  constexpr std::array<std::array<double, 3>, 2> colors{{{120, 160, 200}, {225, 110, 80}}};
  for (std::size_t c = 0; c < 3; ++c) {
    Property channel{std::array{"red", "green", "blue"}[c], "uchar", Eigen::VectorXd(n * n)};
    for (Index i = 0; i < n * n; ++i) channel.values[i] = colors[f[i] > 0 ? 1 : 0][c];
    mesh.properties.push_back(std::move(channel));
  }
  return render(mesh, {.width = 400, .height = 300, .view = {-65, 35}, .ground = Ground::none});
}

}  // namespace csrbf::thesis
