#pragma once

#include "csrbf/implicit/render.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "figure.hpp"

namespace csrbf::thesis {

/// A surface with what the thesis measures of it: |f| (6.16) and Taubin's distance |f| / |grad f| (6.17, 6.36) at the
/// samples, in diagonals of their box.
struct MeasuredSurface {
  std::shared_ptr<const Field<3>> field;
  double centers = 0;
  double mean_offset = 0, rms_offset = 0;
  double mean_taubin = 0, rms_taubin = 0;
};

/// Measures a field at points.
MeasuredSurface measure(std::shared_ptr<const Field<3>> field, double centers, const PointsRef<3>& points);

/// reconstruct() with the given normals and a budget.
MeasuredSurface with_budget(const PointCloud& cloud, const std::string& method, Index centers,
                            std::optional<double> smoothing = {});

/// A mesh of the surface; what its connectivity says.
struct MeshedSurface {
  Mesh mesh;
  Topology topology;

  /// "closed, 1 component".
  [[nodiscard]] std::string words() const;
  [[nodiscard]] bool whole() const { return topology.watertight() && topology.components == 1; }
};
MeshedSurface meshed(const MeasuredSurface& surface, int resolution = 128);

/// How a model is looked at.
struct Look {
  std::array<double, 2> view{20, 15};
  UpAxis up = UpAxis::y;
};

RgbImage picture(const Mesh& mesh, const Look& look, const Box<3>& frame = {});

/// The points as small beads.
RgbImage picture(const PointCloud& cloud, const Look& look, Index most = 6000);

/// The mesh coloured by a length at its vertices: blue (none) to yellow (`largest`).
RgbImage colored(Mesh mesh, const Eigen::VectorXd& length, double largest, const Look& look);

}  // namespace csrbf::thesis
