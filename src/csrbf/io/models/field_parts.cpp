#include "csrbf/io/models/field_parts.hpp"

#include "csrbf/approx/moving/moving_least_squares_field.hpp"
#include "csrbf/approx/unity/partition_of_unity_field.hpp"
#include "csrbf/core/error.hpp"

namespace csrbf {
namespace {

template <class T>
auto column_of(const std::vector<T>& values) {
  return Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, 1>>(values.data(), std::ssize(values));
}

void set_kernel(Archive& archive, const Kernel& kernel) {
  archive.set("kernel", kernel.name());
  archive.set("kernel_dimension", kernel.dimension());
  archive.set("kernel_parameter", kernel.parameter());
}

Kernel kernel_of(const Archive& archive) {
  constexpr int most_dimensions = 64;  // a limit on damaged files
  return Kernel(archive.text("kernel"), static_cast<int>(archive.integer("kernel_dimension", 1, most_dimensions)),
                archive.number("kernel_parameter"));
}

// Whether the nodes are a tree in preorder whose splits lie inside the cells that they divide.
template <int Dim>
bool is_tree(const typename Cover<Dim>::Tree& tree) {
  const std::size_t n = tree.axis.size();
  std::vector<std::pair<std::uint32_t, Box<Dim>>> upper;  // halves still to visit
  Box<Dim> cell = tree.box;
  std::uint32_t cells = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const int axis = tree.axis[i];
    if (axis >= 0) {
      const double split = tree.split[i];
      if (axis >= Dim || !(split > cell.lo[axis] && split < cell.hi[axis])) return false;
      upper.emplace_back(tree.right[i], cell);
      upper.back().second.lo[axis] = cell.hi[axis] = split;
      continue;
    }
    if (tree.right[i] != cells++) return false;
    if (upper.empty()) return i + 1 == n;
    if (upper.back().first != i + 1) return false;
    cell = upper.back().second;
    upper.pop_back();
  }
  return false;
}

template <int Dim>
typename Cover<Dim>::Tree tree_from(const Archive& archive) {
  const auto& nodes = archive.array<std::int64_t>("tree", 2);
  const auto& splits = archive.numbers("tree_splits", nodes.cols(), 1);
  typename Cover<Dim>::Tree tree;
  tree.box = box_of<Dim>(archive);
  tree.growth = archive.number("growth");
  for (Index i = 0; i < nodes.cols(); ++i) {
    if (nodes(0, i) < -1 || nodes(0, i) >= Dim || nodes(1, i) < 0 || nodes(1, i) > nodes.cols())
      archive.fail("the tree is damaged");
    tree.axis.push_back(static_cast<std::int8_t>(nodes(0, i)));
    tree.right.push_back(static_cast<std::uint32_t>(nodes(1, i)));
    tree.split.push_back(splits(i, 0));
  }
  const bool has_volume = (tree.box.lo.array() < tree.box.hi.array()).all() && tree.box.extent().allFinite();
  if (!has_volume || !(tree.growth > 1) || !is_tree<Dim>(tree)) archive.fail("the tree is damaged");
  return tree;
}

template <int Dim>
void set_tree(Archive& archive, const typename Cover<Dim>::Tree& tree) {
  set_box(archive, tree.box);
  archive.set("growth", tree.growth);
  Eigen::Matrix<std::int64_t, 2, Eigen::Dynamic> nodes(2, std::ssize(tree.axis));
  nodes.row(0) = column_of(tree.axis).template cast<std::int64_t>().transpose();
  nodes.row(1) = column_of(tree.right).template cast<std::int64_t>().transpose();
  archive.set("tree", nodes);
  archive.set("tree_splits", tree.split);
}

template <int Dim>
void set_models(Archive& archive, const LocalModels<Dim>& models) {
  set_kernel(archive, models.kernel);
  archive.set("degree", models.degree);
  archive.set("support", models.support);
  archive.set("centers_each", models.centers_each);
  archive.set("components", models.components);
  archive.set("center", models.center);
  archive.set("radius", models.radius);
  if (models.anisotropic) archive.set("metrics", models.metric);
  archive.set("positions", models.position);
  archive.set("coefficients", models.alpha);
  archive.set("polynomials", models.polynomial);
}

template <int Dim>
LocalModels<Dim> models_from(const Archive& archive, Index count) {
  LocalModels<Dim> models;
  // Keeps the products below from overflowing; the monomials have 16-bit indices.
  constexpr Index most = std::numeric_limits<std::int16_t>::max();
  models.kernel = kernel_of(archive);
  models.degree = static_cast<int>(archive.integer("degree", -1, most_degree));
  models.support = positive_number(archive, "support");
  models.centers_each = archive.integer("centers_each", 0, most);
  models.components = archive.integer("components", 1, most);
  if (models.polynomial_size() > most) archive.fail("the degree is too high");
  models.center = archive.numbers("center", Dim, count);
  models.radius = archive.numbers("radius", count, 1);
  if (!(models.radius.minCoeff() > 0)) archive.fail("a radius is not positive");
  models.anisotropic = archive.has("metrics");
  if (models.anisotropic) models.metric = archive.column("metrics", Dim * Dim * count);
  models.position = archive.column("positions", Dim * models.centers_each * count);
  models.alpha = archive.column("coefficients", models.components * models.centers_each * count);
  models.polynomial = archive.column("polynomials", models.components * models.polynomial_size() * count);
  return models;
}

}  // namespace

double positive_number(const Archive& archive, const std::string& name) {
  const double value = archive.number(name);
  if (!(value > 0 && std::isfinite(value))) archive.fail("entry \"" + name + "\" is not positive");
  return value;
}

template <int Dim>
Archive to_archive(const RadialBasis<Dim>& basis) {
  Archive archive;
  archive.kind = basis_kind;
  set_kernel(archive, basis.kernel());
  archive.set("centers", basis.centers());
  archive.set("supports", basis.supports());
  const auto& transforms = basis.metric().transforms;
  Eigen::MatrixXd columns(Dim * Dim, std::ssize(transforms));
  for (Index j = 0; j < columns.cols(); ++j) columns.col(j) = transforms[j].reshaped();
  archive.set("transforms", columns);
  archive.set("periods", basis.metric().periods);
  return archive;
}

template <int Dim>
std::shared_ptr<const RadialBasis<Dim>> basis_from(const Archive& archive) {
  RadialMetric<Dim> metric;
  const auto& columns = archive.numbers("transforms", Dim * Dim);
  for (Index j = 0; j < columns.cols(); ++j) metric.transforms.emplace_back(columns.col(j).reshaped(Dim, Dim));
  metric.periods = archive.numbers("periods", Dim, 1);
  const Points<Dim> centers = archive.numbers("centers", Dim);
  const Eigen::VectorXd supports = archive.numbers("supports", -1, 1);
  return std::make_shared<const RadialBasis<Dim>>(kernel_of(archive), centers, supports, metric);
}

template <int Dim>
Archive patches_to_archive(const typename PartitionOfUnity<Dim>::Data& data) {
  Archive archive;
  archive.kind = patches_kind;
  set_tree<Dim>(archive, data.cover.tree());
  set_models(archive, data.models);
  if (data.wide_of.empty()) return archive;
  Archive wide;
  wide.kind = "local functions";
  set_models(wide, data.wide);
  archive.set("wide", std::move(wide));
  archive.set("wide_of", data.wide_of);
  return archive;
}

template <int Dim>
std::shared_ptr<const typename PartitionOfUnity<Dim>::Data> patches_from(const Archive& archive) {
  using Data = typename PartitionOfUnity<Dim>::Data;
  auto data = std::make_shared<Data>(Data{Cover<Dim>(tree_from<Dim>(archive)), {}});
  data->models = models_from<Dim>(archive, data->cover.size());
  if (!archive.has("wide_of")) return data;
  const Archive wide = archive.part("wide");
  const auto& wide_of = archive.array<std::int32_t>("wide_of", data->cover.size(), 1);
  const Index count = wide_of.size() == 0 ? 0 : static_cast<Index>(wide_of.maxCoeff()) + 1;
  if (count < 1 || wide_of.minCoeff() < -1) archive.fail("the numbers of the wide functions are damaged");
  data->wide = models_from<Dim>(wide, count);
  if (data->wide.components != data->models.components) archive.fail("the wide functions have other components");
  data->wide_of.assign(wide_of.data(), wide_of.data() + wide_of.size());
  return data;
}

template <int Dim>
Archive samples_to_archive(const typename MovingLeastSquares<Dim>::Data& data) {
  Archive archive;
  archive.kind = samples_kind;
  set_kernel(archive, data.kernel);
  if (data.directions.cols() > 0) archive.set("directions", data.directions);
  archive.set("degree", data.bases.back().degree());
  archive.set("points", data.samples.points);
  archive.set("values", data.samples.values);
  archive.set("weights", data.samples.weights);
  archive.set("radii", data.radii);
  return archive;
}

template <int Dim>
std::shared_ptr<const typename MovingLeastSquares<Dim>::Data> samples_from(const Archive& archive) {
  Samples<Dim> samples;
  samples.points = archive.numbers("points", Dim);
  samples.values = archive.numbers("values", samples.size());
  samples.weights = archive.numbers("weights", -1, 1);
  require_valid(samples, "read_model");
  const auto& radii = archive.numbers("radii", samples.size(), 1);
  if (!(radii.minCoeff() > 0)) archive.fail("a radius is not positive");
  auto data = std::make_shared<typename MovingLeastSquares<Dim>::Data>(
      std::move(samples), kernel_of(archive), static_cast<int>(archive.integer("degree", 0, most_degree)));
  data->set_radii(radii);
  if (archive.has("directions")) data->directions = archive.numbers("directions", Dim, data->samples.size());
  return data;
}

// Patches have any number of centres: all are stored one after the other.
template <int Dim>
Archive hermite_to_archive(const typename HermiteField<Dim>::Data& data) {
  Archive archive;
  archive.kind = hermite_kind;
  archive.set("kernel", data.kernel.name());
  const Index components = data.patches.front().mean.size();
  std::vector<std::int64_t> sizes;
  Index total = 0;
  for (const auto& patch : data.patches) {
    sizes.push_back(patch.centers.cols());
    total += patch.centers.cols();
  }
  Eigen::MatrixXd centers(Dim, total), coefficients((1 + Dim) * total, components);
  Eigen::MatrixXd means(components, std::ssize(sizes)), variances(components, std::ssize(sizes));
  Index first = 0, number = 0;
  for (const auto& patch : data.patches) {
    const Index n = patch.centers.cols();
    centers.middleCols(first, n) = patch.centers;
    coefficients.middleRows((1 + Dim) * first, (1 + Dim) * n) = patch.coefficients;
    means.col(number) = patch.mean;
    variances.col(number++) = patch.variance;
    first += n;
  }
  archive.set("sizes", sizes);
  archive.set("centers", centers);
  archive.set("coefficients", coefficients);
  archive.set("means", means);
  archive.set("patch_variances", variances);
  archive.set("has_cover", data.cover ? 1 : 0);
  if (data.cover)
    set_tree<Dim>(archive, data.cover->tree());
  else
    set_box(archive, data.box);
  if (!data.system) return archive;
  archive.set("nuggets", data.system->nuggets);  // infinite where unknown
  archive.set("sigma2", data.sigma2);
  archive.set("noise", data.noise);
  return archive;
}

template <int Dim>
std::shared_ptr<const typename HermiteField<Dim>::Data> hermite_from(const Archive& archive) {
  auto data = std::make_shared<typename HermiteField<Dim>::Data>();
  data->kernel = HermiteKernel(archive.text("kernel"));
  data->box = box_of<Dim>(archive);
  const auto& sizes = archive.array<std::int64_t>("sizes", -1, 1);
  const auto& centers = archive.numbers("centers", Dim, -1);
  const auto& means = archive.numbers("means", -1, sizes.size());
  const Index components = means.rows();
  const auto& coefficients = archive.numbers("coefficients", (1 + Dim) * centers.cols(), components);
  const auto& variances = archive.numbers("patch_variances", components, sizes.size());
  if (sizes.size() == 0 || components == 0) archive.fail("there are no systems");
  Index first = 0;
  for (Index k = 0; k < sizes.size(); ++k) {
    const Index n = sizes(k, 0);
    if (n < 0 || n > centers.cols() - first) archive.fail("the sizes of the systems are damaged");
    data->patches.push_back({centers.middleCols(first, n), coefficients.middleRows((1 + Dim) * first, (1 + Dim) * n),
                             means.col(k), variances.col(k)});
    first += n;
  }
  if (archive.integer("has_cover", 0, 1) == 1) {
    data->cover.emplace(tree_from<Dim>(archive));
    if (data->cover->size() != sizes.size()) archive.fail("there is not one system per support");
    return data;
  }
  if (sizes.size() != 1) archive.fail("several systems need a cover");
  HermiteSystem<Dim> system{Points<Dim>(centers), archive.array<double>("nuggets", centers.cols(), 1 + Dim)};
  if (!(system.nuggets.array() >= 0).all()) archive.fail("the noise is damaged");
  data->system = std::move(system);
  data->sigma2 = archive.numbers("sigma2", components, 1);
  data->noise = archive.number("noise");
  if (!(data->sigma2.minCoeff() >= 0) || !(data->noise >= 0) || !std::isfinite(data->noise))
    archive.fail("the variance is damaged");
  return data;
}

// All vertices of the faults one after the other.
Archive faults_to_archive(const FaultField::Data& data) {
  Archive archive;
  archive.kind = faults_kind;
  std::vector<std::int64_t> sizes;
  Index total = 0;
  for (const Eigen::Matrix2Xd& line : data.faults.lines()) {
    sizes.push_back(line.cols());
    total += line.cols();
  }
  Eigen::Matrix2Xd vertices(2, total);
  Index first = 0;
  for (const Eigen::Matrix2Xd& line : data.faults.lines()) {
    vertices.middleCols(first, line.cols()) = line;
    first += line.cols();
  }
  archive.set("line_sizes", sizes);
  archive.set("vertices", vertices);
  archive.set("anchors", data.anchors);
  archive.set("radii", data.radii);
  archive.set(data.prediction ? "disc_sigma2" : "disc_variances", data.variances);
  if (data.prediction) {
    archive.set("nugget", data.prediction->nugget);
    archive.set("sigma2", data.prediction->sigma2);
    archive.set("disc_weights", data.prediction->weights);
  }
  set_box(archive, data.box);
  set_models(archive, data.models);
  return archive;
}

std::shared_ptr<const FaultField::Data> faults_from(const Archive& archive) {
  const auto& sizes = archive.array<std::int64_t>("line_sizes", -1, 1);
  const auto& vertices = archive.numbers("vertices", 2, -1);
  std::vector<Eigen::Matrix2Xd> lines;
  Index first = 0;
  for (Index k = 0; k < sizes.size(); ++k) {
    const Index n = sizes(k, 0);
    if (n < 2 || n > vertices.cols() - first) archive.fail("the faults are damaged");
    lines.emplace_back(vertices.middleCols(first, n));
    first += n;
  }
  const Points<2> anchors = archive.numbers("anchors", 2, -1);
  if (anchors.cols() == 0) archive.fail("there are no discs");
  LocalModels<2> models = models_from<2>(archive, anchors.cols());
  const bool is_older = archive.has("disc_variances");  // of one variance for each disc
  const Eigen::MatrixXd variances =
      archive.numbers(is_older ? "disc_variances" : "disc_sigma2", models.components, anchors.cols());
  std::optional<FaultField::Prediction> prediction;
  if (!is_older) {
    prediction = {archive.number("nugget"), archive.numbers("sigma2", models.components, 1),
                  archive.numbers("disc_weights", models.centers_each, anchors.cols())};
    const Eigen::MatrixXd& weights = prediction->weights;
    bool ordered = true;  // those of no sample come last
    for (Index k = 1; k < weights.rows(); ++k)
      ordered = ordered && ((weights.row(k).array() == 0) || (weights.row(k - 1).array() > 0)).all();
    const bool positive = weights.rows() > 0 && weights.row(0).minCoeff() > 0 && weights.minCoeff() >= 0;
    if (!ordered || !positive || !weights.allFinite() || !(prediction->nugget > 0) || !(prediction->nugget < 1e6) ||
        !(prediction->sigma2.minCoeff() >= 0) || !prediction->sigma2.allFinite() || !(variances.minCoeff() >= 0) ||
        !variances.allFinite())
      archive.fail("the variance is damaged");
  }
  return std::make_shared<const FaultField::Data>(FaultLines(std::move(lines)), anchors,
                                                  archive.numbers("radii", anchors.cols(), 1), std::move(models),
                                                  variances, box_of<2>(archive), std::move(prediction));
}

#define CSRBF_INSTANTIATE(Dim)                          \
  template Archive to_archive(const RadialBasis<Dim>&); \
  template std::shared_ptr<const RadialBasis<Dim>> basis_from(const Archive&);
CSRBF_FOR_MANY_DIMS(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

#define CSRBF_INSTANTIATE(Dim)                                                                     \
  template Archive patches_to_archive<Dim>(const PartitionOfUnity<Dim>::Data&);                    \
  template std::shared_ptr<const PartitionOfUnity<Dim>::Data> patches_from<Dim>(const Archive&);   \
  template Archive samples_to_archive<Dim>(const MovingLeastSquares<Dim>::Data&);                  \
  template std::shared_ptr<const MovingLeastSquares<Dim>::Data> samples_from<Dim>(const Archive&); \
  template Archive hermite_to_archive<Dim>(const HermiteField<Dim>::Data&);                        \
  template std::shared_ptr<const HermiteField<Dim>::Data> hermite_from<Dim>(const Archive&);
CSRBF_FOR_EACH_DIM(CSRBF_INSTANTIATE)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
