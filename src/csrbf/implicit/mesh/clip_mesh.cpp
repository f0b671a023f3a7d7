#include "csrbf/implicit/mesh/clip_mesh.hpp"

#include "csrbf/core/error.hpp"

#include <unordered_map>

namespace csrbf {
namespace {

constexpr double margin = 0.05;  // of an edge, between a cut and its ends: no slivers. Chosen by hand

// A new vertex on the edge from a to b.
struct Cut {
  std::int32_t a, b;
  double t;
};

class Clipper {
 public:
  Clipper(const Mesh& mesh, const Eigen::VectorXd& value) : mesh_(mesh), value_(value) {}

  Mesh clip() {
    for (Index t = 0; t < mesh_.triangles.cols(); ++t) add(mesh_.triangles.col(t));
    number_vertices();
    Mesh part;
    part.space = mesh_.space;
    part.vertices = interpolated(mesh_.vertices);
    if (mesh_.normals.cols() > 0) part.normals = interpolated_normals();
    for (const Property& property : mesh_.properties)
      part.properties.push_back({property.name, property.type, interpolated(property.values.transpose()).transpose()});
    part.triangles.resize(3, std::ssize(corners_) / 3);
    for (Index i = 0; i < part.triangles.size(); ++i) part.triangles.data()[i] = number_[corners_[i]];
    return part;
  }

 private:
  // Old vertices and, after these, cuts.
  void add(const Eigen::Vector3i& triangle) {
    std::vector<std::int32_t> loop;
    for (int c = 0; c < 3; ++c) {
      const std::int32_t from = triangle[c], to = triangle[(c + 1) % 3];
      if (value_[from] >= 0) loop.push_back(from);
      if ((value_[from] >= 0) != (value_[to] >= 0)) loop.push_back(cut(from, to));
    }
    for (std::size_t i = 2; i < loop.size(); ++i) corners_.insert(corners_.end(), {loop[0], loop[i - 1], loop[i]});
  }

  std::int32_t cut(std::int32_t from, std::int32_t to) {
    const std::int32_t a = std::min(from, to), b = std::max(from, to);
    const auto next = static_cast<std::int32_t>(mesh_.vertices.cols() + std::ssize(cuts_));
    const auto [found, is_new] = cut_of_.emplace(static_cast<std::int64_t>(a) << 32 | b, next);
    if (is_new) {
      const double t = value_[a] / (value_[a] - value_[b]);
      cuts_.push_back({a, b, std::isfinite(t) ? std::clamp(t, margin, 1 - margin) : 0.5});
    }
    return found->second;
  }

  // Numbers of the vertices that are left.
  void number_vertices() {
    number_.assign(static_cast<std::size_t>(mesh_.vertices.cols()) + cuts_.size(), -1);
    for (const std::int32_t corner : corners_) number_[corner] = 0;
    for (std::size_t v = 0; v < number_.size(); ++v)
      if (number_[v] == 0) {
        number_[v] = static_cast<std::int32_t>(kept_.size());
        kept_.push_back(static_cast<Index>(v));
      }
  }

  // Columns at the vertices that are left.
  [[nodiscard]] Eigen::MatrixXd interpolated(const Eigen::Ref<const Eigen::MatrixXd>& values) const {
    Eigen::MatrixXd result(values.rows(), std::ssize(kept_));
    for (Index i = 0; i < result.cols(); ++i) {
      const Index v = kept_[i], old = mesh_.vertices.cols();
      if (v < old) {
        result.col(i) = values.col(v);
      } else {
        const Cut& cut = cuts_[v - old];
        result.col(i) = (1 - cut.t) * values.col(cut.a) + cut.t * values.col(cut.b);
      }
    }
    return result;
  }

  // Those of cuts are as long as their ends' in the mean.
  [[nodiscard]] Points<3> interpolated_normals() const {
    Points<3> normals = interpolated(mesh_.normals);
    for (Index i = 0; i < normals.cols(); ++i) {
      if (kept_[i] < mesh_.vertices.cols()) continue;
      const Cut& cut = cuts_[kept_[i] - mesh_.vertices.cols()];
      const double length = (1 - cut.t) * mesh_.normals.col(cut.a).norm() + cut.t * mesh_.normals.col(cut.b).norm();
      normals.col(i) = length * normals.col(i).normalized();
    }
    return normals;
  }

  const Mesh& mesh_;
  const Eigen::VectorXd& value_;
  std::vector<Cut> cuts_;
  std::unordered_map<std::int64_t, std::int32_t> cut_of_;
  std::vector<std::int32_t> corners_, number_;
  std::vector<Index> kept_;
};

}  // namespace

Mesh clip_mesh(const Mesh& mesh, const Eigen::VectorXd& value) {
  require(value.size() == mesh.vertices.cols(), "clip_mesh", "value.size()", value.size(), "must be one per vertex");
  return Clipper(mesh, value).clip();
}

}  // namespace csrbf
