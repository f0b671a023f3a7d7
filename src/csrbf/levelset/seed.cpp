#include "csrbf/levelset/seed.hpp"

#include "csrbf/core/error.hpp"

#include <Eigen/Geometry>

#include <functional>

namespace csrbf {
namespace {

constexpr Index part = Index{1} << 18;  // voxels at a time: 6 MB of centres

void check_dimension(const Grid& grid, int dim) {
  require(grid.dimension() <= dim, "seed", "dimension of the image", grid.dimension(),
          "must not exceed " + std::to_string(dim));
}

// Calls use(first voxel, physical centres) for all voxels, some of them at a time.
template <int Dim>
void for_all_centers(const Grid& grid, const std::function<void(Index first, const Points<Dim>& centers)>& use) {
  const auto map = grid.to_physical<3>();
  const auto [nx, ny, nz] = grid.size;
  for (Index begin = 0; begin < grid.voxels(); begin += part) {
    Points<Dim> centers(Dim, std::min(part, grid.voxels() - begin));
    for (Index k = 0; k < centers.cols(); ++k) {
      const Index i = begin + k;
      const Point<3> voxel(static_cast<double>(i % nx), static_cast<double>(i / nx % ny),
                           static_cast<double>(i / nx / ny));
      centers.col(k) = (map * voxel).template head<Dim>();
    }
    use(begin, centers);
  }
}

template <int Dim, class Inside>
Seed seed_where(const Grid& grid, const Inside& inside) {
  check_dimension(grid, Dim);
  Seed seed(static_cast<std::size_t>(grid.voxels()), 0);
  for_all_centers<Dim>(grid, [&](Index first, const Points<Dim>& centers) {
    for (Index k = 0; k < centers.cols(); ++k) seed[first + k] = inside(Point<Dim>(centers.col(k))) ? 1 : 0;
  });
  return seed;
}

}  // namespace

template <int Dim>
Seed seed_ball(const Grid& grid, const Point<Dim>& center, double radius) {
  require(center.allFinite(), "seed_ball", "center", center.transpose(), "must be finite");
  require(radius > 0 && std::isfinite(radius), "seed_ball", "radius", radius, "must be positive");
  Seed seed = seed_where<Dim>(grid, [&](const Point<Dim>& p) { return (p - center).squaredNorm() <= radius * radius; });
  const Point<Dim> voxel = (grid.to_voxel<Dim>() * center).array().round();
  Point<3> at = Point<3>::Zero();
  at.template head<Dim>() = voxel;
  for (Index a = 0; a < 3; ++a)
    if (!(at[a] >= 0 && at[a] < static_cast<double>(grid.size[a]))) return seed;
  const auto whole = at.cast<Index>();
  seed[grid.index(whole[0], whole[1], whole[2])] = 1;
  return seed;
}

template <int Dim>
Seed seed_box(const Grid& grid, const Box<Dim>& box) {
  require(!box.empty(), "seed_box", "box", box.lo.transpose(), "the lower corner must not exceed the upper one");
  return seed_where<Dim>(grid, [&](const Point<Dim>& p) { return box.contains(p); });
}

Seed seed_polygon(const Grid& grid, const Points<2>& corners) {
  require(corners.cols() >= 3, "seed_polygon", "number of corners", corners.cols(), "must be at least 3");
  require(corners.allFinite(), "seed_polygon", "corners", "not finite", "must be finite");
  const Point<2> mean = corners.rowwise().mean();
  std::vector<Point<2>> ring;
  for (Index i = 0; i < corners.cols(); ++i) ring.emplace_back(corners.col(i));
  const auto angle = [&](const Point<2>& p) { return std::atan2(p.y() - mean.y(), p.x() - mean.x()); };
  std::stable_sort(ring.begin(), ring.end(), [&](const Point<2>& a, const Point<2>& b) { return angle(a) < angle(b); });
  return seed_where<2>(grid, [&](const Point<2>& p) {
    bool inside = false;  // an odd number of sides is to the right
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
      if ((ring[i].y() > p.y()) != (ring[j].y() > p.y()) &&
          p.x() < ring[i].x() + (p.y() - ring[i].y()) / (ring[j].y() - ring[i].y()) * (ring[j].x() - ring[i].x()))
        inside = !inside;
    return inside;
  });
}

template <int Dim>
Seed seed_inside(const Grid& grid, const Field<Dim>& field) {
  check_dimension(grid, Dim);
  Seed seed(static_cast<std::size_t>(grid.voxels()), 0);
  for_all_centers<Dim>(grid, [&](Index first, const Points<Dim>& centers) {
    const Eigen::VectorXd f = field.evaluate(centers).value;
    for (Index k = 0; k < f.size(); ++k) seed[first + k] = f[k] > 0 ? 1 : 0;
  });
  return seed;
}

#define CSRBF_INSTANTIATE(Dim)                                          \
  template Seed seed_ball<Dim>(const Grid&, const Point<Dim>&, double); \
  template Seed seed_box<Dim>(const Grid&, const Box<Dim>&);            \
  template Seed seed_inside<Dim>(const Grid&, const Field<Dim>&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
