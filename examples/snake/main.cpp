#include "snake.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/levelset/baselines/collocation.hpp"
#include "csrbf/levelset/baselines/finite_difference.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <string>
#include <vector>

namespace {

using csrbf::Grid;
using csrbf::Index;
using csrbf::Point;
using Labels = std::vector<unsigned char>;

constexpr const char* usage =
    "usage: csrbf-snake [PICTURE.png]\n\n"
    "Segments four synthetic pictures by snakes, moving polygons (thesis eq. 7.1), and by level sets, from the same\n"
    "circle: a flower from close by, the same from a small circle inside, a disc with two holes, and two discs. "
    "Prints\n"
    "the Dice coefficient of each with the truth. Snakes driven by edges see only edges nearby, and no snake can make\n"
    "holes or split: around two discs it crosses itself. With an argument, the last picture is also drawn, with the\n"
    "best snake in red and the level set in green.\n";

constexpr Index size = 120;

struct Picture {
  const char* name;
  double (*inside)(double x, double y);
  Point<2> center;
  double radius;  // of the start
  bool needs_topology;
};

double disc(double x, double y, double cx, double cy, double r) {
  return r - std::hypot(x - cx, y - cy);
}

double flower(double x, double y) {
  return 32 + 6 * std::cos(5 * std::atan2(y - 60, x - 60)) - std::hypot(x - 60, y - 60);
}

double holes(double x, double y) {
  return std::min({disc(x, y, 60, 60, 40), -disc(x, y, 45, 60, 10), -disc(x, y, 76, 64, 9)});
}

double two_discs(double x, double y) {
  return std::max(disc(x, y, 36, 60, 20), disc(x, y, 86, 60, 22));
}

const std::array<Picture, 4> pictures = {{{"flower, near", flower, {60, 60}, 36, false},
                                          {"flower, far", flower, {66, 57}, 10, false},
                                          {"two holes", holes, {60, 60}, 44, true},
                                          {"two discs", two_discs, {60, 60}, 52, true}}};

Grid grid_of_pictures() {
  Grid grid;
  grid.axes = 2;
  grid.size = {size, size, 1};
  return grid;
}

struct Case {
  std::vector<float> values;
  Labels truth;
};

Case draw(const Picture& picture) {
  constexpr double bright = 200, dark = 80, noise = 15;
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, noise);
  Case drawn;
  for (Index i = 0; i < size * size; ++i) {
    const bool inside = picture.inside(static_cast<double>(i % size), static_cast<double>(i / size)) > 0;
    drawn.truth.push_back(inside ? 1 : 0);
    drawn.values.push_back(static_cast<float>((inside ? bright : dark) + normal(random)));
  }
  return drawn;
}

double dice(const Labels& a, const Labels& b) {
  double both = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] & b[i];
    sum += a[i] + b[i];
  }
  return 2 * both / sum;
}

// (I - C1)^2 - (I - C2)^2 with the means inside and outside.
void chan_vese(const std::vector<float>& values, const unsigned char* labels, float* force) {
  std::array<double, 2> sum{}, count{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum[labels[i]] += static_cast<double>(values[i]);
    ++count[labels[i]];
  }
  const double inside = sum[1] / std::max(count[1], 1.0), outside = sum[0] / std::max(count[0], 1.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto I = static_cast<double>(values[i]);
    force[i] = static_cast<float>(std::pow(I - inside, 2) - std::pow(I - outside, 2));
  }
}

// Values between the pixels, and beyond the border those of it.
double sample(const std::vector<double>& values, const Point<2>& p) {
  const double x = std::clamp(p.x(), 0.0, size - 1.001), y = std::clamp(p.y(), 0.0, size - 1.001);
  const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
  const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
  const std::size_t at = i + static_cast<std::size_t>(size) * j;
  return (1 - v) * ((1 - u) * values[at] + u * values[at + 1]) +
         v * ((1 - u) * values[at + size] + u * values[at + size + 1]);
}

// Three means over 3 x 3 pixels: about a Gaussian of 1.4 pixels.
std::vector<double> blurred(std::vector<double> values) {
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> next(values.size());
    for (Index y = 0; y < size; ++y)
      for (Index x = 0; x < size; ++x) {
        double sum = 0;
        for (Index dy = -1; dy <= 1; ++dy)
          for (Index dx = -1; dx <= 1; ++dx)
            sum += values[std::clamp<Index>(x + dx, 0, size - 1) + size * std::clamp<Index>(y + dy, 0, size - 1)];
        next[x + size * y] = sum / 9;
      }
    values.swap(next);
  }
  return values;
}

Point<2> gradient(const std::vector<double>& values, const Point<2>& p) {
  return {0.5 * (sample(values, p + Point<2>(1, 0)) - sample(values, p - Point<2>(1, 0))),
          0.5 * (sample(values, p + Point<2>(0, 1)) - sample(values, p - Point<2>(0, 1)))};
}

// Pulls towards where the blurred picture changes most, with a force of size 1 at most.
SnakeForce edge_force(const std::vector<float>& values) {
  const std::vector<double> smooth = blurred({values.begin(), values.end()});
  std::vector<double> strength(smooth.size());
  for (Index i = 0; i < size * size; ++i)
    strength[i] = gradient(smooth, {static_cast<double>(i % size), static_cast<double>(i / size)}).norm();
  strength = blurred(std::move(strength));
  double largest = 0;
  for (Index i = 0; i < size * size; ++i)
    largest =
        std::max(largest, gradient(strength, {static_cast<double>(i % size), static_cast<double>(i / size)}).norm());
  return [strength, largest](const Polygon& points, const Polygon& /*normals*/, Polygon& force) {
    for (Index i = 0; i < points.cols(); ++i) force.col(i) = gradient(strength, points.col(i)) / largest;
  };
}

// <V, n> n of eq. (7.1) with the forces that also move the level sets.
SnakeForce region_force(const std::vector<float>& values) {
  return [&values](const Polygon& points, const Polygon& normals, Polygon& force) {
    std::vector<float> cost(values.size());
    chan_vese(values, fill(points, size).data(), cost.data());
    double largest = 0;
    for (const float c : cost) largest = std::max(largest, std::abs(static_cast<double>(c)));
    const std::vector<double> smooth = blurred({cost.begin(), cost.end()});
    for (Index i = 0; i < points.cols(); ++i)
      force.col(i) = -sample(smooth, points.col(i)) / std::max(largest, 1.0) * normals.col(i);
  };
}

struct Row {
  Polygon snake;
  Labels level_set;
  std::array<double, 4> dice{};
};

Row run(const Picture& picture) {
  const Case drawn = draw(picture);
  const Grid grid = grid_of_pictures();
  const Polygon start = circle(picture.center, picture.radius);
  const Labels start_labels = fill(start, size);
  const auto force = [&](const unsigned char* labels, float* out) { chan_vese(drawn.values, labels, out); };
  Row row;
  row.dice[0] = dice(fill(move_snake(start, edge_force(drawn.values)), size), drawn.truth);
  row.snake = move_snake(start, region_force(drawn.values));
  row.dice[1] = dice(fill(row.snake, size), drawn.truth);
  row.dice[2] =
      dice(csrbf::finite_difference<2>(grid, start_labels.data(), force, {.length = 0.2}).labels, drawn.truth);
  row.level_set = csrbf::collocate<2>(grid, csrbf::regular_nodes<2>(grid, 1.5), start_labels.data(), force).labels;
  row.dice[3] = dice(row.level_set, drawn.truth);
  return row;
}

void write_picture(const std::string& path, const Picture& picture, const Row& row) {
  constexpr int zoom = 4;
  const Case drawn = draw(picture);
  csrbf::RgbImage image(size * zoom, size * zoom);
  const auto paint = [&](Index x, Index y, int channel) {
    for (int c = 0; c < 3; ++c) image.pixels[3 * (x + size * zoom * y) + c] = c == channel ? 255 : 0;
  };
  const auto label = [&](Index x, Index y) { return row.level_set[x / zoom + size * (y / zoom)]; };
  for (Index y = 0; y < size * zoom; ++y)
    for (Index x = 0; x < size * zoom; ++x) {
      const float value = drawn.values[x / zoom + size * (y / zoom)];
      for (int c = 0; c < 3; ++c)
        image.pixels[3 * (x + size * zoom * y) + c] = static_cast<std::uint8_t>(std::clamp(value, 0.F, 255.F));
      if (x > 0 && y > 0 && (label(x, y) != label(x - 1, y) || label(x, y) != label(x, y - 1))) paint(x, y, 1);
    }
  for (Index i = 0; i < row.snake.cols(); ++i)
    for (int k = 0; k < 2 * zoom; ++k) {
      const double t = static_cast<double>(k) / (2 * zoom);
      const Point<2> p =
          (1 - t) * row.snake.col(i) + t * row.snake.col((i + 1) % row.snake.cols()) + Point<2>::Constant(0.5);
      const auto x = static_cast<Index>(p.x() * zoom), y = static_cast<Index>(p.y() * zoom);
      if (x >= 0 && y >= 0 && x < size * zoom && y < size * zoom) paint(x, y, 0);
    }
  csrbf::write_png(path, image);
}

// What the table is to show.
bool as_expected(const Picture& picture, const Row& row) {
  constexpr double good = 0.97, bad = 0.95;
  const bool level_sets = row.dice[3] > good;
  if (picture.needs_topology) return level_sets && row.dice[0] < bad && row.dice[1] < bad;
  const bool near = picture.radius > 30;
  return level_sets && row.dice[2] > good && row.dice[1] > good && (near ? row.dice[0] > good : row.dice[0] < bad);
}

int run_all(const std::string& path) {
  bool right = true;
  std::printf("Dice with the truth    snake: edges  snake: regions  finite differences  CSRBF collocation\n");
  for (const Picture& picture : pictures) {
    const Row row = run(picture);
    const bool expected = as_expected(picture, row);
    std::printf("%-20s %14.4f %15.4f %19.4f %18.4f%s\n", picture.name, row.dice[0], row.dice[1], row.dice[2],
                row.dice[3], expected ? "" : "  not as expected");
    right = right && expected;
    if (!path.empty() && &picture == &pictures.back()) write_picture(path, picture, row);
  }
  return right ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string argument = argc > 1 ? argv[1] : "";
  if (argc > 2 || argument == "--help" || argument == "-h") {
    std::fputs(usage, argc > 2 ? stderr : stdout);
    return argc > 2 ? 2 : 0;
  }
  try {
    return run_all(argument);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csrbf-snake: %s\n", error.what());
    return 1;
  }
}
