#include "csrbf/core/shared_work.hpp"

#include "core/shared_work_testing.hpp"
#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/core/shared_evaluate.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>

namespace csrbf {
namespace {

// A smooth field that likes its points in descending order of x.
class Wave : public Field<2> {
 public:
  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    for (Index seen = largest_block; seen < x.cols() && !largest_block.compare_exchange_weak(seen, x.cols());) {
    }
    for (Index i = 0; i < x.cols(); ++i) {
      out.value[i] = std::sin(x(0, i)) * x(1, i);
      if (out.gradient != nullptr) {
        out.gradient[2 * i] = std::cos(x(0, i)) * x(1, i);
        out.gradient[2 * i + 1] = std::sin(x(0, i));
      }
    }
  }
  [[nodiscard]] Box<2> bounds() const override { return {Point<2>(0, 0), Point<2>(1, 1)}; }
  [[nodiscard]] std::vector<Index> evaluation_order(const PointsRef<2>& x) const override {
    std::vector<Index> order(x.cols());
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return x(0, a) > x(0, b); });
    return order;
  }

  mutable std::atomic<Index> largest_block = 0;
};

std::vector<double> squares(Index n) {
  std::vector<double> result(n);
  share_arrays("squares", n, 10,
               [&](Index begin, Index end) {
                 for (Index i = begin; i < end; ++i) result[i] = static_cast<double>(i * i);
               },
               {ResultArray::of(result.data())});
  return result;
}

void expect_equal(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a, b);
}

TEST(SharedWork, ArraysAreTheSameWhoeverComputesThem) {
  const auto names = compare_with_ranks(
      3, [] { return squares(1234); }, expect_equal);
  EXPECT_EQ(names, (std::map<std::string, Index>{{"squares", 1234}}));
}

TEST(SharedWork, NobodyGetsASingleBlockOrWorkInsideALoop) {
  PretendRank::Record record;
  const PretendRank sharing(record);
  EXPECT_EQ(squares(10).back(), 81);
  EXPECT_EQ(sharing.works(), 0);
  std::vector<double> inner;
  parallel_for(1, 1, [&](Index, Index) { inner = squares(11); });
  EXPECT_EQ(inner.back(), 100);
  EXPECT_EQ(sharing.works(), 0);
  EXPECT_EQ(squares(11).back(), 100);
  EXPECT_EQ(sharing.works(), 1);
}

TEST(SharedWork, BlocksCoverTheItems) {
  const SharedWork work{"blocks", 25, 10, {}, {}, {}};
  EXPECT_EQ(work.blocks(), 3);
  EXPECT_EQ(work.begin(2), 20);
  EXPECT_EQ(work.end(2), 25);
}

TEST(SharedWork, AFieldIsEvaluatedAsWithoutSharing) {
  const Points<2> x = Points<2>::Random(2, 3000);
  const auto names = compare_with_ranks(
      2, [&] { return shared_evaluate(Wave(), x, Derivatives::gradient); },
      [&](const Jet<2>& a, const Jet<2>& b) {
        EXPECT_TRUE(a.value == b.value);
        EXPECT_TRUE(a.gradient == b.gradient);
      });
  EXPECT_EQ(names.at("evaluate"), 3000);
  EXPECT_TRUE(Wave().evaluate(x).value == shared_evaluate(Wave(), x).value);
}

TEST(SharedWork, AFieldIsEvaluatedInTheBlocksItIsWithoutSharing) {
  constexpr Index n = 400000;  // more than blocks of the usual size are made for
  const Points<2> x = Points<2>::Random(2, n);
  const Wave field, shared;
  const Jet<2> expected = field.evaluate(x, Derivatives::gradient);
  PretendRank::Record record;
  const PretendRank sharing(record);
  const Jet<2> jet = shared_evaluate(shared, x, Derivatives::gradient);
  EXPECT_EQ(sharing.works(), 1);
  EXPECT_TRUE(jet.value == expected.value);
  EXPECT_TRUE(jet.gradient == expected.gradient);
  EXPECT_EQ(shared.largest_block, field.largest_block);
  EXPECT_EQ(field.largest_block, Field<2>::ordered_block_size(n));
}

TEST(SharedWork, ValuesComeBackInTheOrderTheyWereWritten) {
  ByteWriter out;
  const std::vector<double> values = {1.5, -2};
  out.put(Index{7});
  out.put(values.data(), 2);
  out.put(true);
  ByteReader in(out.bytes());
  EXPECT_EQ(in.take<Index>(), 7);
  std::vector<double> taken(2);
  in.take(taken.data(), 2);
  EXPECT_EQ(taken, values);
  EXPECT_TRUE(in.take<bool>());
  EXPECT_EQ(in.left(), 0U);
  EXPECT_THROW(in.take<char>(), SolverFailure);
}

}  // namespace
}  // namespace csrbf
