#include "table_2_4.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/global/interpolate.hpp"
#include "csrbf/approx/sums/fast_sum.hpp"
#include "csrbf/linalg/sparse_cholesky.hpp"
#include "csrbf/spatial/morton_order.hpp"
#include "signals.hpp"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>

namespace csrbf::thesis {

namespace {

constexpr double support_in_spacings = 3;

double some_function(const Point<2>& p) {
  return std::sin(5 * p[0]) * std::cos(7 * p[1]);
}

// The symbolic part of a factorisation is enough to count its entries.
struct SymbolicFactor : Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> {
  explicit SymbolicFactor(const Eigen::SparseMatrix<double>& A) { analyzePattern(A); }
  [[nodiscard]] double nonzeros() const { return static_cast<double>(m_matrix.nonZeros()); }
};

}  // namespace

Costs compact_costs(Index samples) {
  const Points<2> p = random_points<2>(samples, 1);
  const Eigen::VectorXd s = values_at(p, some_function);
  const auto n = static_cast<double>(samples);
  const Eigen::VectorXd support = Eigen::VectorXd::Constant(1, support_in_spacings / std::sqrt(n));

  Costs costs{.samples = n};
  std::shared_ptr<const RadialBasis<2>> basis;
  Eigen::SparseMatrix<double> A;
  costs.assembly = seconds([&] {
    basis = std::make_shared<const RadialBasis<2>>(Kernel("wendland-c2", 2), p, support);
    A = basis->matrix(p);
  });
  Eigen::VectorXd alpha;
  costs.solve = seconds([&] {
    SparseCholesky solver({.method = SparseMethod::direct});
    solver.factorize(A);
    alpha = solver.solve(s);
  });
  costs.nonzeros = static_cast<double>(A.nonZeros()) / n;
  costs.factor = SymbolicFactor(A).nonzeros() / n;

  const Points<2> x = random_points<2>(100000, 2);
  const Expansion<2> f(basis, alpha);
  costs.evaluation = seconds([&] { static_cast<void>(f.evaluate(x)); }, 3) / static_cast<double>(x.cols());
  return costs;
}

Costs global_costs(Index samples) {
  const Points<2> p = random_points<2>(samples, 1);
  const Eigen::VectorXd s = values_at(p, some_function);
  const auto n = static_cast<double>(samples);

  Costs costs{.samples = n, .nonzeros = n, .factor = n / 2};
  std::shared_ptr<const RadialBasis<2>> basis;
  Eigen::MatrixXd A;
  costs.assembly = seconds([&] {
    basis = std::make_shared<const RadialBasis<2>>(Kernel("linear", 2), p, Eigen::VectorXd::Ones(1));
    A = basis->dense_matrix(p);
  });
  Eigen::VectorXd alpha;
  costs.solve = seconds([&] { alpha = Eigen::PartialPivLU<Eigen::MatrixXd>(A).solve(s); });

  const Points<2> x = random_points<2>(20000, 2);
  const Expansion<2> f(basis, alpha);
  costs.evaluation = seconds([&] { static_cast<void>(f.evaluate(x)); }) / static_cast<double>(x.cols());
  return costs;
}

Costs fast_costs(Index samples) {
  const Points<2> p = random_points<2>(samples, 1);
  const auto n = static_cast<double>(samples);
  Costs costs{.samples = n, .nonzeros = n, .factor = 0};
  costs.assembly = seconds([&] { const FastSum<2> sums(p, Kernel("linear", 2), 1, {.everywhere = true}); });
  Interpolation<2> fit;
  Samples<2> given{p, values_at(p, some_function), {}};
  costs.solve = seconds([&] { fit = interpolate(given, {.kernel = "linear", .dense_limit = 1}); });
  const Points<2> x = random_points<2>(100000, 2);
  const Expansion<2>& f = *fit.components.front();
  static_cast<void>(f.evaluate(x.leftCols(1)));  // its expansions
  costs.evaluation = seconds([&] { static_cast<void>(f.evaluate(x)); }) / static_cast<double>(x.cols());
  return costs;
}

namespace {

Table table_of(const std::string& name, const std::vector<Costs>& all) {
  Table table{
      .name = name,
      .columns = {"samples", "assembly [s]", "solve [s]", "evaluation [us / point]", "nonzeros / row", "factor / row"}};
  for (const Costs& c : all)
    table.rows.push_back({c.samples, c.assembly, c.solve, 1e6 * c.evaluation, c.nonzeros, c.factor});
  return table;
}

std::string order_of(const std::vector<Costs>& all, double Costs::*cost) {
  std::vector<double> n, t;
  for (const Costs& c : all) {
    n.push_back(c.samples);
    t.push_back(c.*cost);
  }
  return "N^" + number(slope(n, t), 2);
}

}  // namespace

Figure table_2_4() {
  Figure figure{
      .name = "table-2.4",
      .title = "Table 2.4: costs against the number of samples",
      .text =
          "Interpolation of random samples of the unit square: Wendland's C2 function with a support of "
          "3 mean distances against the kernel -r with a dense matrix and its LU decomposition, and against the "
          "same kernel with sums by a fast multipole method and conjugate gradients. Orders are "
          "least squares slopes of the measured times. The table of the thesis speaks of operations; "
          "caches and threads make times grow a little differently."};
  std::vector<Costs> compact, global, fast;
  for (const Index n : {1000, 2000, 5000, 10000, 20000, 50000, 100000}) compact.push_back(compact_costs(n));
  for (const Index n : {500, 1000, 2000, 4000}) global.push_back(global_costs(n));
  for (const Index n : {10000, 20000, 50000, 100000}) fast.push_back(fast_costs(n));
  figure.tables = {table_of("compact", compact), table_of("global", global), table_of("fast", fast)};

  const auto row = [&](const std::string& what, const std::string& published, double Costs::*cost) {
    figure.claims.push_back({what + ", compact | global", published,
                             order_of(compact, cost) + " | " + order_of(global, cost), Verdict::not_comparable});
  };
  row("build the matrix", "O(N log N) | O(N^2)", &Costs::assembly);
  row("solve", "O(nzf) | O(N^3)", &Costs::solve);
  row("nonzeros of the factor", "nzf, much less than N^3 | N^2 / 2", &Costs::factor);
  figure.claims.back().ours = order_of(compact, &Costs::factor) + " per row, " + number(compact.back().factor, 2) +
                              " per row at N = 1e5 | N / 2 per row";
  row("evaluate at one point", "O(log N) | O(N)", &Costs::evaluation);
  figure.claims.push_back({"global support by fast sums: solve, evaluate at one point", "O(N log N), O(log N)",
                           order_of(fast, &Costs::solve) + ", " + order_of(fast, &Costs::evaluation),
                           Verdict::not_comparable});
  return figure;
}

}  // namespace csrbf::thesis
