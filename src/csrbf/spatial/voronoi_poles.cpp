#include "csrbf/spatial/voronoi_poles.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <cstdio>
#include <cstdlib>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace csrbf {
namespace {

// Half the side of the box of additional sites, in units of the largest extent of the points. Chosen by hand: larger
// ones give poles of open cells that are farther away, but lose digits.
constexpr double far_sites = 3;

// Captures the messages of qhull, which writes to files only. Windows has none in memory.
class Messages {
 public:
#ifdef _WIN32
  Messages() : file_(std::fopen("NUL", "w")) {}
#else
  Messages() : file_(open_memstream(&text_, &size_)) {}
#endif
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;
  ~Messages() {
    if (file_ != nullptr) std::fclose(file_);
    std::free(text_);
  }

  [[nodiscard]] std::FILE* file() const {
    return file_;
  }
  [[nodiscard]] std::string first_line() const {
    if (file_ != nullptr) std::fflush(file_);
    if (text_ == nullptr) return "qhull cannot triangulate these points";
    const std::string all(text_, size_);
    return all.substr(0, all.find('\n'));
  }

 private:
  char* text_ = nullptr;
  std::size_t size_ = 0;
  std::FILE* file_;
};

// A Delaunay triangulation in memory owned by qhull.
template <int Dim>
class Delaunay {
 public:
  explicit Delaunay(Points<Dim>& sites) {
    qh_zero(&hull_, messages_.file());
    // d: Delaunay triangulation; Qbb: scales the lifted coordinate; QJ: joggles the sites, so that cospherical ones
    // give simplices.
    char command[] = "qhull d Qbb QJ";
    const int status =
        qh_new_qhull(&hull_, Dim, static_cast<int>(sites.cols()), sites.data(), 0, command, nullptr, messages_.file());
    if (status == 0) {
      qh_setvoronoi_all(&hull_);
      return;
    }
    const std::string reason = messages_.first_line();
    release();
    throw SolverFailure("voronoi_poles: " + reason);
  }
  Delaunay(const Delaunay&) = delete;
  Delaunay& operator=(const Delaunay&) = delete;
  ~Delaunay() { release(); }

  // Calls use(site, corner) for every site and corner of its Voronoi cell.
  template <class Use>
  void for_each_corner(const Use& use) {
    qhT* qh = &hull_;
    for (const facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      if (facet->upperdelaunay || facet->center == nullptr) continue;
      const Eigen::Map<const Point<Dim>> corner(facet->center);
      const int count = qh_setsize(qh, facet->vertices);
      for (int k = 0; k < count; ++k) {
        const auto* vertex = static_cast<const vertexT*>(facet->vertices->e[k].p);
        use(static_cast<Index>(qh_pointid(qh, vertex->point)), Point<Dim>(corner));
      }
    }
  }

 private:
  void release() {
    qh_freeqhull(&hull_, True);
    int long_blocks = 0, long_bytes = 0;
    qh_memfreeshort(&hull_, &long_blocks, &long_bytes);
  }

  Messages messages_;
  qhT hull_;
};

}  // namespace

template <int Dim>
VoronoiPoles<Dim> voronoi_poles(const PointsRef<Dim>& points) {
  require(points.allFinite(), "voronoi_poles", "points", "NaN or infinity", "every coordinate must be finite");
  const Index n = points.cols();
  VoronoiPoles<Dim> poles{Points<Dim>::Constant(Dim, n, std::numeric_limits<double>::quiet_NaN()),
                          Points<Dim>::Constant(Dim, n, std::numeric_limits<double>::quiet_NaN())};
  const Box<Dim> box = bounding_box<Dim>(points);
  const double extent = box.extent().maxCoeff();
  if (!(extent > 0)) return poles;

  constexpr Index corners = Index{1} << Dim;
  Points<Dim> sites(Dim, n + corners);
  sites.leftCols(n) = (points.colwise() - box.center()) / extent;
  for (Index i = 0; i < corners; ++i)
    for (int a = 0; a < Dim; ++a) sites(a, n + i) = ((i >> a) & 1) != 0 ? far_sites : -far_sites;

  Delaunay<Dim> diagram(sites);
  Eigen::VectorXd farthest = Eigen::VectorXd::Zero(n);
  diagram.for_each_corner([&](Index site, const Point<Dim>& corner) {
    if (site < 0 || site >= n) return;
    const double distance = (corner - sites.col(site)).squaredNorm();
    if (!(distance > farthest[site])) return;
    farthest[site] = distance;
    poles.positive.col(site) = corner;
  });
  farthest.setZero();
  diagram.for_each_corner([&](Index site, const Point<Dim>& corner) {
    if (site < 0 || site >= n) return;
    const Point<Dim> p = sites.col(site), direction = corner - p;
    const double distance = direction.squaredNorm();
    if (!(distance > farthest[site]) || !(direction.dot(poles.positive.col(site) - p) < 0)) return;
    farthest[site] = distance;
    poles.negative.col(site) = corner;
  });
  poles.positive = ((extent * poles.positive).colwise() + box.center()).eval();
  poles.negative = ((extent * poles.negative).colwise() + box.center()).eval();
  return poles;
}

template <int Dim>
Eigen::VectorXd medial_axis_distances(const PointsRef<Dim>& points, const VoronoiPoles<Dim>& poles) {
  Points<Dim> negative(Dim, poles.negative.cols());
  Index count = 0;
  for (Index i = 0; i < poles.negative.cols(); ++i)
    if (poles.negative.col(i).allFinite()) negative.col(count++) = poles.negative.col(i);
  negative.conservativeResize(Dim, count);
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(points.cols(), std::numeric_limits<double>::infinity());
  if (count == 0) return distances;
  const KdTree<Dim> tree(negative);
  parallel_for(points.cols(), 1024, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      Index nearest = 0;
      tree.nearest(points.col(i), 1, &nearest, &distances[i]);
      distances[i] = std::sqrt(distances[i]);
    }
  });
  return distances;
}

#define CSRBF_INSTANTIATE(Dim)                                          \
  template VoronoiPoles<Dim> voronoi_poles<Dim>(const PointsRef<Dim>&); \
  template Eigen::VectorXd medial_axis_distances<Dim>(const PointsRef<Dim>&, const VoronoiPoles<Dim>&);
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
