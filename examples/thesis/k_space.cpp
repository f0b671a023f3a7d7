#include "k_space.hpp"

#include "csrbf/approx/fit.hpp"
#include "csrbf/spatial/kd_tree.hpp"
#include "signals.hpp"

#include <cmath>
#include <numbers>

namespace csrbf::thesis {

using std::numbers::pi;

double Ellipse::level(const Point<2>& p) const {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double u = (c * (p[0] - x) + s * (p[1] - y)) / a;
  const double v = (c * (p[1] - y) - s * (p[0] - x)) / b;
  return std::hypot(u, v);
}

std::complex<double> Ellipse::transform(const Point<2>& k) const {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double rho = 2 * pi * std::hypot(a * (c * k[0] + s * k[1]), b * (c * k[1] - s * k[0]));
  // The transform of the unit disk is 2 pi J1(rho) / rho.
  const double disk = rho < 1e-8 ? pi : 2 * pi * std::cyl_bessel_j(1.0, rho) / rho;
  return value * a * b * disk * std::polar(1.0, -2 * pi * (k[0] * x + k[1] * y));
}

std::vector<Ellipse> head_phantom(double scale) {
  const double degree = pi / 180;
  std::vector<Ellipse> ellipses{{1, .69, .92, 0, 0, 0},
                                {-.8, .6624, .874, 0, -.0184, 0},
                                {-.2, .11, .31, .22, 0, -18 * degree},
                                {-.2, .16, .41, -.22, 0, 18 * degree},
                                {.1, .21, .25, 0, .35, 0},
                                {.1, .046, .046, 0, .1, 0},
                                {.1, .046, .046, 0, -.1, 0},
                                {.1, .046, .023, -.08, -.605, 0},
                                {.1, .023, .023, 0, -.606, 0},
                                {.1, .023, .046, .06, -.605, 0}};
  for (Ellipse& e : ellipses) e.a *= scale, e.b *= scale, e.x *= scale, e.y *= scale;
  return ellipses;
}

Points<2> trajectory(Trajectory kind, Index side) {
  const double radius = static_cast<double>(side) / 2;
  if (kind == Trajectory::radial) {
    const auto spokes = static_cast<Index>(std::llround(1.6 * static_cast<double>(side)));
    const Index along = 2 * side;
    Points<2> points(2, spokes * along);
    for (Index i = 0; i < points.cols(); ++i) {
      const double angle = pi * static_cast<double>(i / along) / static_cast<double>(spokes);
      const double r = radius * (2 * (static_cast<double>(i % along) + .5) / static_cast<double>(along) - 1);
      points.col(i) << r * std::cos(angle), r * std::sin(angle);
    }
    return points;
  }
  // Turns of one spiral are arms * gap apart: arms turns fill the disk with gaps of `gap`.
  const Index arms = side / 2;
  constexpr double gap = 0.8;
  const double last_angle = 2 * pi * radius / (gap * static_cast<double>(arms));
  const auto along = 4 * side;
  Points<2> points(2, arms * along);
  for (Index i = 0; i < points.cols(); ++i) {
    const double t = (static_cast<double>(i % along) + .5) / static_cast<double>(along);
    const double angle = last_angle * t + 2 * pi * static_cast<double>(i / along) / static_cast<double>(arms);
    points.col(i) << radius * t * std::cos(angle), radius * t * std::sin(angle);
  }
  return points;
}

Eigen::MatrixXcd image_of(const Eigen::MatrixXcd& k_space) {
  const Index n = k_space.rows();
  Eigen::MatrixXcd W(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index m = 0; m < n; ++m)
      W(j, m) = std::polar(.5, 2 * pi * static_cast<double>((j - n / 2) * (m - n / 2)) / static_cast<double>(n));
  return W * k_space * W.transpose();
}

namespace {

// k = (index - side / 2) / 2: a field of view of 2 wants a grid of 1/2.
constexpr double grid_spacing = 0.5;
constexpr double phantom_scale = 0.55;

Eigen::MatrixXd phantom_transform(const Points<2>& indices) {
  const std::vector<Ellipse> phantom = head_phantom(phantom_scale);
  Eigen::MatrixXd values(indices.cols(), 2);
  for (Index i = 0; i < indices.cols(); ++i) {
    std::complex<double> sum = 0;
    for (const Ellipse& e : phantom) sum += e.transform(grid_spacing * indices.col(i));
    values.row(i) << sum.real(), sum.imag();
  }
  return values;
}

Points<2> grid_indices(Index side) {
  return lattice(side, -static_cast<double>(side) / 2, static_cast<double>(side) / 2 - 1);
}

// Values on the grid; what is outside of the sampled disk is 0.
Eigen::MatrixXcd on_grid(const Eigen::MatrixXd& values, const Points<2>& indices, Index side) {
  Eigen::MatrixXcd grid(side, side);
  const double radius = static_cast<double>(side) / 2 - 1;
  for (Index i = 0; i < indices.cols(); ++i)
    grid(i) = indices.col(i).norm() <= radius ? std::complex<double>(values(i, 0), values(i, 1)) : 0.0;
  return grid;
}

Eigen::MatrixXd nearest_samples(const Samples<2>& samples, const Points<2>& indices) {
  const KdTree<2> tree(samples.points);
  Eigen::MatrixXd values(indices.cols(), 2);
  for (Index i = 0; i < indices.cols(); ++i) {
    Index nearest = 0;
    double distance = 0;
    tree.nearest(indices.col(i), 1, &nearest, &distance);
    values.row(i) = samples.values.row(nearest);
  }
  return values;
}

Eigen::MatrixXd means_in_cells(const Samples<2>& samples, Index side) {
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(side * side, 2);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(side * side);
  for (Index i = 0; i < samples.size(); ++i) {
    const auto x = static_cast<Index>(std::llround(samples.points(0, i))) + side / 2;
    const auto y = static_cast<Index>(std::llround(samples.points(1, i))) + side / 2;
    if (x < 0 || y < 0 || x >= side || y >= side) continue;
    sums.row(x + side * y) += samples.values.row(i);
    counts[x + side * y] += 1;
  }
  return sums.array().colwise() / counts.array().max(1);
}

double image_error(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  return (a - b).norm() / b.norm();
}

}  // namespace

KSpaceResult reconstruct_k_space(Trajectory kind, Index side) {
  const Points<2> places = trajectory(kind, side);
  const Samples<2> samples{places, phantom_transform(places), {}};
  const Points<2> indices = grid_indices(side);
  KSpaceResult result{.samples = samples.size()};

  Eigen::MatrixXd fitted(indices.cols(), 2);
  result.fit_seconds = seconds([&] {
    const Fit<2> f = fit<2>(samples, {.scale_axes = false});
    for (Index part = 0; part < 2; ++part) fitted.col(part) = f.components[part]->evaluate(indices).value;
  });
  const auto image = [&](const Eigen::MatrixXd& values) { return image_of(on_grid(values, indices, side)); };
  const Eigen::MatrixXcd reference = image(phantom_transform(indices));
  const Eigen::MatrixXcd fit_image = image(fitted);
  const Eigen::MatrixXcd nearest_image = image(nearest_samples(samples, indices));
  result.fit_error = image_error(fit_image, reference);
  result.nearest_error = image_error(nearest_image, reference);
  result.gridding_error = image_error(image(means_in_cells(samples, side)), reference);
  result.reference = reference.real();
  result.fit = fit_image.real();
  result.nearest = nearest_image.real();
  return result;
}

Figure k_space() {
  constexpr Index side = 128;
  Figure figure{
      .name = "k-space",
      .title = "Irregular k-space: an open perspective of the thesis",
      .text =
          "The exact Fourier transform of a phantom of ten ellipses that fills half of the field of view, "
          "sampled on spokes and on interleaved spirals; real and imaginary part are fitted as one sample "
          "of two values by the default fit, evaluated on the grid of 128 x 128 and transformed back. "
          "Errors are relative to the image of the exact transform on the same grid, inside the sampled "
          "disk. Nearest-neighbour gridding is the simplest method; convolution gridding with density weights "
          "is not compared."};
  Table table{.name = "errors",
              .columns = {"trajectory", "samples", "fit", "nearest sample", "nearest grid place", "fit seconds"}};
  for (const Trajectory kind : {Trajectory::radial, Trajectory::spiral}) {
    const std::string name = kind == Trajectory::radial ? "radial" : "spiral";
    const KSpaceResult r = reconstruct_k_space(kind, side);
    table.rows.push_back({kind == Trajectory::radial ? 0.0 : 1.0, static_cast<double>(r.samples), r.fit_error,
                          r.nearest_error, r.gridding_error, r.fit_seconds});
    const auto add = [&](const std::string& what, const Eigen::MatrixXd& image) {
      figure.pictures.push_back({what, side, side, image.reshaped()});
    };
    if (kind == Trajectory::radial) add("exact grid", r.reference);
    add(name + ", fit", r.fit);
    add(name + ", nearest sample", r.nearest);
    figure.claims.push_back({name + " trajectory, error of the image", "a perspective, no numbers",
                             "fit " + number(100 * r.fit_error, 2) + " %, nearest sample " +
                                 number(100 * r.nearest_error, 2) + " %, nearest grid place " +
                                 number(100 * r.gridding_error, 2) + " %",
                             verdict(r.fit_error < r.nearest_error && r.fit_error < r.gridding_error)});
  }
  figure.tables.push_back(table);
  return figure;
}

}  // namespace csrbf::thesis
