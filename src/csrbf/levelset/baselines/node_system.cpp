#include "csrbf/levelset/baselines/node_system.hpp"

#include "csrbf/approx/basis/polynomial_block.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/linalg/sparse_cholesky.hpp"
#include "csrbf/linalg/toeplitz_system.hpp"
#include "csrbf/spatial/coincident_points.hpp"
#include "csrbf/spatial/kd_tree.hpp"

#include <Eigen/LU>

namespace csrbf {
namespace {

constexpr const char* node_system_class = "NodeSystem";

// Below this a sparse factor takes some milliseconds, and its solutions are exact to rounding.
constexpr Index few_nodes = 2500;

// phi - diffusion (laplacian + bias) phi at distance r support, in units of the support.
struct Weight {
  const Kernel& kernel;
  double diffusion, bias;
  double operator()(double r) const {
    const double phi = kernel.value(r);
    return diffusion > 0 ? phi - diffusion * (kernel.laplacian(r) + bias * phi) : phi;
  }
};

template <int Dim>
std::vector<ToeplitzTap<Dim>> taps_of(const Nodes<Dim>& nodes, double support, const Weight& weight) {
  Eigen::Matrix<double, Dim, Dim> steps;
  Index stride = 1;
  for (Index a = 0; a < Dim; stride *= nodes.size[a], ++a)
    steps.col(a) = nodes.points.col(stride) - nodes.points.col(0);
  // |steps k| < support implies |k_a| < support |row a of the inverse|.
  const Eigen::Matrix<double, Dim, Dim> inverse = steps.inverse();
  std::array<Index, Dim> reach, k;
  for (Index a = 0; a < Dim; ++a) {
    reach[a] = static_cast<Index>(support * inverse.row(a).norm());
    k[a] = -reach[a];
  }
  std::vector<ToeplitzTap<Dim>> taps;
  for (;;) {
    Point<Dim> offset;
    for (Index a = 0; a < Dim; ++a) offset[a] = static_cast<double>(k[a]);
    const double r = (steps * offset).norm() / support;
    if (r < 1) taps.push_back({k, weight(r)});
    Index a = 0;
    for (; a < Dim && ++k[a] > reach[a]; ++a) k[a] = -reach[a];
    if (a == Dim) return taps;
  }
}

// - sum laplacian phi / sum phi over an endless lattice, in units of the support.
template <int Dim>
double bias_of(const Nodes<Dim>& nodes, double support, const Kernel& kernel) {
  if (!nodes.regular() || !kernel.compact() || kernel.smoothness() < 2) return 0;
  const auto sum = [&](double diffusion) {
    double total = 0;
    for (const ToeplitzTap<Dim>& tap : taps_of<Dim>(nodes, support, Weight{kernel, diffusion, 0})) total += tap.weight;
    return total;
  };
  const double plain = sum(0);
  return (sum(1) - plain) / plain;
}

template <int Dim>
Eigen::SparseMatrix<double> sparse_matrix(const Points<Dim>& points, double support, const Weight& weight) {
  const Index n = points.cols();
  const KdTree<Dim> tree(points);
  std::vector<std::vector<Index>> columns(n);
  parallel_for(n, 256, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j) tree.within(points.col(j), support, columns[j]);
  });
  Eigen::SparseMatrix<double> H(n, n);
  Eigen::VectorXi sizes(n);
  for (Index j = 0; j < n; ++j) sizes[j] = static_cast<int>(columns[j].size());
  H.reserve(sizes);
  for (Index j = 0; j < n; ++j)
    for (const Index i : columns[j]) H.insert(i, j) = weight((points.col(i) - points.col(j)).norm() / support);
  H.makeCompressed();
  return H;
}

}  // namespace

template <int Dim>
struct NodeSystem<Dim>::Impl {
  std::shared_ptr<const RadialBasis<Dim>> basis;
  PolynomialBlock<Dim> polynomials;
  std::optional<ToeplitzSystem<Dim>> toeplitz;
  Eigen::SparseMatrix<double> sparse;
  SparseCholesky factor;
  Eigen::MatrixXd dense;  // bordered
  double laplacian_bias = 0;
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;

  void prepare_dense(const Points<Dim>& points, double support, const Weight& weight);
};

template <int Dim>
void NodeSystem<Dim>::Impl::prepare_dense(const Points<Dim>& points, double support, const Weight& weight) {
  constexpr double enough = 1e-6;  // error at the nodes of values of size 1; by hand
  const Index n = points.cols(), Q = polynomials.G.cols();
  require(n <= dense_limit, node_system_class, "number of nodes", n,
          "must be at most 4000 for a kernel that is not compact; use a Wendland function or fewer nodes");
  dense.setZero(n + Q, n + Q);
  parallel_for(n, 16, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j)
      for (Index i = 0; i < n; ++i) dense(i, j) = weight((points.col(i) - points.col(j)).norm() / support);
  });
  dense.topRightCorner(n, Q) = polynomials.G;
  dense.bottomLeftCorner(Q, n) = polynomials.G.transpose();
  lu.compute(dense);
  // Values that change sign from node to node are the hardest.
  Eigen::VectorXd hardest = Eigen::VectorXd::Zero(n + Q);
  for (Index i = 0; i < n; ++i) hardest[i] = i % 2 == 0 ? 1 : -1;
  if (!((dense * lu.solve(hardest) - hardest).cwiseAbs().maxCoeff() < enough))
    throw SolverFailure("NodeSystem: the matrix is singular to working precision; use a smaller support");
}

template <int Dim>
NodeSystem<Dim>::NodeSystem(const Nodes<Dim>& nodes, const Kernel& kernel, double support, double diffusion)
    : impl_(std::make_unique<Impl>()) {
  require(support > 0 && std::isfinite(support), node_system_class, "support", support, "must be positive");
  require(diffusion >= 0 && std::isfinite(diffusion), node_system_class, "diffusion", diffusion,
          "must not be negative");
  require(diffusion == 0 || (kernel.order() == 0 && kernel.smoothness() >= 2), node_system_class, "kernel",
          kernel.name(), "must be positive definite with two derivatives for a diffusion");
  const Index n = nodes.points.cols();
  if (nodes.regular()) {
    Index product = 1;
    for (const Index count : nodes.size) product *= count;
    require(product == n, node_system_class, "number of nodes", n,
            "must be the product of their numbers along the axes");
  }
  const std::vector<Index> first = first_coincident<Dim>(nodes.points);
  for (Index i = 0; i < n; ++i)
    require(first[i] == i, node_system_class, "node", i, "must not be at the place of another one");
  impl_->basis = std::make_shared<const RadialBasis<Dim>>(kernel, nodes.points, Eigen::VectorXd::Constant(1, support));
  impl_->polynomials = polynomial_block<Dim>(nodes.points, kernel.order() - 1, RankDeficiency::keep);
  const double bias = bias_of<Dim>(nodes, support, kernel);
  impl_->laplacian_bias = bias / (support * support);
  const Weight weight{impl_->basis->kernel(), diffusion / (support * support), bias};
  if (!kernel.compact()) {
    impl_->prepare_dense(nodes.points, support, weight);
  } else if (nodes.regular() && n > few_nodes) {
    impl_->toeplitz.emplace(nodes.size, taps_of<Dim>(nodes, support, weight));
  } else {
    impl_->sparse = sparse_matrix<Dim>(nodes.points, support, weight);
    if (!impl_->factor.factorize(impl_->sparse))
      throw SolverFailure(
          "NodeSystem: the matrix is not positive definite to working precision; use a smaller support");
  }
}

template <int Dim>
NodeSystem<Dim>::~NodeSystem() = default;

template <int Dim>
Eigen::VectorXd NodeSystem<Dim>::solve(const Eigen::VectorXd& values) const {
  require(values.size() == nodes(), "NodeSystem::solve", "number of values", values.size(), "must be one per node");
  if (impl_->toeplitz) return impl_->toeplitz->solve(values);
  if (impl_->dense.size() == 0) return impl_->factor.solve(values);
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(impl_->dense.rows());
  padded.head(nodes()) = values;
  return impl_->lu.solve(padded);
}

template <int Dim>
Eigen::VectorXd NodeSystem<Dim>::multiply(const Eigen::VectorXd& mu) const {
  if (impl_->toeplitz) return impl_->toeplitz->multiply(mu);
  if (impl_->dense.size() == 0) return impl_->sparse * mu;
  return impl_->dense.topRows(nodes()) * mu;
}

template <int Dim>
std::shared_ptr<const Expansion<Dim>> NodeSystem<Dim>::expansion(const Eigen::VectorXd& mu, const Box<Dim>& bounds,
                                                                 double constant) const {
  const Index Q = impl_->polynomials.G.cols();
  PolynomialTail<Dim> tail = impl_->polynomials.tail(mu.tail(Q));
  if (constant != 0) {
    require(Q == 0, "NodeSystem::expansion", "constant", constant, "must be 0 for a kernel with polynomials");
    tail.degree = 0;
    tail.coefficients = Eigen::VectorXd::Constant(1, constant);
  }
  return std::make_shared<const Expansion<Dim>>(impl_->basis, mu.head(nodes()), std::move(tail), bounds);
}

template <int Dim>
double NodeSystem<Dim>::laplacian_bias() const {
  return impl_->laplacian_bias;
}

template <int Dim>
Index NodeSystem<Dim>::nodes() const {
  return impl_->basis->size();
}

template <int Dim>
const RadialBasis<Dim>& NodeSystem<Dim>::basis() const {
  return *impl_->basis;
}

template class NodeSystem<2>;
template class NodeSystem<3>;

}  // namespace csrbf
