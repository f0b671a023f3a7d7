#include "csrbf/core/field.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>

namespace csrbf::field_test {
namespace {

// x^2 y; counts blocks, and points of a block that are not next to each other in the order it asks for.
class Counting : public Field<2> {
 public:
  explicit Counting(bool ordered) : ordered_(ordered) {}

  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    ++blocks;
    for (Index i = 0; i < x.cols(); ++i) {
      if (i > 0 && x(0, i) < x(0, i - 1)) ++descents;
      out.value[i] = x(0, i) * x(0, i) * x(1, i);
      if (out.gradient != nullptr) {
        out.gradient[2 * i] = 2 * x(0, i) * x(1, i);
        out.gradient[2 * i + 1] = x(0, i) * x(0, i);
      }
      if (out.hessian != nullptr) {
        out.hessian[3 * i] = 2 * x(1, i);
        out.hessian[3 * i + 1] = 2 * x(0, i);
        out.hessian[3 * i + 2] = 0;
      }
    }
  }
  [[nodiscard]] Box<2> bounds() const override { return {}; }
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<2>& x) const override {
    if (!ordered_) return {};
    std::vector<Index> order(x.cols());
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index i, Index j) { return x(0, i) < x(0, j); });
    return order;
  }

  mutable std::atomic<Index> blocks = 0, descents = 0;

 private:
  bool ordered_;
};

// Numbers in [-1, 1] without any order.
Points<2> scattered(Index n) {
  Points<2> x(2, n);
  for (Index i = 0; i < 2 * n; ++i) x.data()[i] = std::sin(1e3 * static_cast<double>(i * i % 1009));
  return x;
}

void expect_jets(const Jet<2>& jet, const Points<2>& x, Derivatives derivatives) {
  ASSERT_EQ(jet.value.size(), x.cols());
  ASSERT_EQ(jet.gradient.cols(), derivatives >= Derivatives::gradient ? x.cols() : 0);
  ASSERT_EQ(jet.hessian.cols(), derivatives >= Derivatives::hessian ? x.cols() : 0);
  for (Index i = 0; i < x.cols(); ++i) {
    const double u = x(0, i), v = x(1, i);
    EXPECT_EQ(jet.value[i], u * u * v);
    if (derivatives >= Derivatives::gradient) {
      EXPECT_EQ(jet.gradient.col(i), Point<2>(2 * u * v, u * u));
    }
    if (derivatives >= Derivatives::hessian) {
      EXPECT_EQ(jet.hessian.col(i), Eigen::Vector3d(2 * v, 2 * u, 0));
    }
  }
}

TEST(Field, EvaluatesAnyNumberOfPoints) {
  for (const bool ordered : {false, true})
    for (const Index n : {0, 1, 511, 512, 513, 3000})
      for (const Derivatives derivatives : {Derivatives::none, Derivatives::gradient, Derivatives::hessian})
        expect_jets(Counting(ordered).evaluate(scattered(n), derivatives), scattered(n), derivatives);
}

TEST(Field, EvaluatesPointsInTheOrderItAsksFor) {
  const Counting ordered(true), given(false);
  (void)ordered.evaluate(scattered(3000));
  (void)given.evaluate(scattered(3000));
  EXPECT_EQ(ordered.blocks, 6);
  EXPECT_EQ(ordered.descents, 0);
  EXPECT_GT(given.descents, 1000);
}

TEST(Field, TakesLargerBlocksOfManyPointsInOrder) {
  constexpr Index n = 400000;
  const Counting ordered(true), given(false);
  const Points<2> x = scattered(n);
  expect_jets(ordered.evaluate(x, Derivatives::hessian), x, Derivatives::hessian);
  expect_jets(given.evaluate(x), x, Derivatives::none);
  const Index size = Field<2>::ordered_block_size(n);
  EXPECT_EQ(ordered.blocks, (n + size - 1) / size);
  EXPECT_EQ(ordered.descents, 0);
  EXPECT_EQ(given.blocks, (n + Field<2>::block_size - 1) / Field<2>::block_size);
}

TEST(Field, LeavesWorkForManyThreadsInBlocksOfAnySize) {
  constexpr Index enough = 256;  // blocks, where there are points for them
  for (Index n = 1; n < Index{1} << 34; n = 3 * n + 1) {
    const Index size = Field<2>::ordered_block_size(n);
    EXPECT_GE(size, Field<2>::block_size);
    EXPECT_LE(size, 8192);
    EXPECT_TRUE(size == Field<2>::block_size || n / size >= enough) << n;
  }
}

TEST(Field, KeepsTheOrderOfASingleBlock) {
  const Counting field(true);
  (void)field.evaluate(scattered(Field<2>::block_size));
  EXPECT_EQ(field.blocks, 1);
  EXPECT_GT(field.descents, 0);
}

TEST(Field, EvaluatesColumnsOfALargerMatrix) {
  Eigen::MatrixXd rows(3, 700);
  rows.topRows(2) = scattered(700);
  rows.row(2).setConstant(77);
  for (const bool ordered : {false, true})
    expect_jets(Counting(ordered).evaluate(rows.topRows<2>(), Derivatives::hessian), scattered(700),
                Derivatives::hessian);
}

TEST(Field, HasNoOrderSeedsOrDetailUnlessItKnows) {
  const Counting field(false);
  EXPECT_TRUE(field.evaluation_order(scattered(10)).empty());
  EXPECT_EQ(field.seeds().cols(), 0);
  EXPECT_EQ(field.feature_size(), 0);
}

}  // namespace
}  // namespace csrbf::field_test
