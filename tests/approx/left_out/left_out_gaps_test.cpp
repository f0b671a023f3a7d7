#include "csrbf/approx/left_out/left_out_gaps.hpp"

#include "approx/approx_testing.hpp"

namespace csrbf::left_out_gaps_test {
namespace {

// A function of the points; not for derivatives.
class Values : public Field<2> {
 public:
  explicit Values(std::function<double(const Point<2>&)> f) : f_(std::move(f)) {}
  void evaluate_block(const PointsRef<2>& x, const JetBlock& out) const override {
    for (Index i = 0; i < x.cols(); ++i) out.value[i] = f_(x.col(i));
  }
  [[nodiscard]] Box<2> bounds() const override { return {Point<2>(0, 0), Point<2>(1, 1)}; }

 private:
  std::function<double(const Point<2>&)> f_;
};

std::shared_ptr<const Field<2>> constant(double value) {
  return std::make_shared<Values>([value](const Point<2>&) { return value; });
}

double step_up(const Point<2>& x) {
  return x[0] < .5 ? 1 : 3;
}

bool is_in_gap(const Point<2>& x) {
  return x[0] > .7 && x[1] > .7;
}

Samples<2> with_gap() {
  const Points<2> all = random_points<2>(1000, 1);
  std::vector<Index> chosen;
  for (Index i = 0; i < all.cols(); ++i)
    if (!is_in_gap(all.col(i))) chosen.push_back(i);
  return sample<2>(all(Eigen::all, chosen), step_up);
}

const Values outside([](const Point<2>& x) { return is_in_gap(x) ? 0 : 1; });

using Fits = std::vector<std::function<FittedParts<2>(const Samples<2>&)>>;

TEST(LeftOutGaps, LeavesSamplesOutInMovedGaps) {
  const Samples<2> samples = with_gap();
  std::vector<Index> seen;
  const auto right = [&](const Samples<2>& some) {
    seen.push_back(some.size());
    return FittedParts<2>{{std::make_shared<Values>(step_up)}, {constant(4)}};
  };
  const auto wrong = [&](const Samples<2>&) { return FittedParts<2>{{constant(0)}, {constant(.25)}}; };
  const auto errors = left_out_gaps<2>(samples, outside, Fits{right, wrong});
  ASSERT_EQ(errors.size(), 2);
  ASSERT_EQ(seen.size(), 2);
  EXPECT_EQ(errors[0].places.size(), 2);
  for (const Index count : seen) {
    EXPECT_LT(count, samples.size() - 50);
    EXPECT_GT(count, samples.size() / 2);
  }
  EXPECT_EQ(errors[0].mean_square(0), 0);
  EXPECT_EQ(errors[0].growth(0), 0);
  EXPECT_GE(errors[1].mean_square(0), 1);
  EXPECT_LE(errors[1].mean_square(0), 9);
}

// The place that asks for more counts.
TEST(LeftOutGaps, Growth) {
  LeftOutErrors errors{Eigen::MatrixXd::Constant(200, 1, 1.96), Eigen::MatrixXd::Constant(200, 1, 1), {0, 100}};
  EXPECT_NEAR(errors.growth(0), 1, 1e-12);
  errors.errors.bottomRows(100).setConstant(2 * 1.96);
  EXPECT_NEAR(errors.growth(0), 4, 1e-12);
}

// Nothing is left out without gaps.
TEST(LeftOutGaps, NoneWithoutGaps) {
  const auto any = [](const Samples<2>&) { return FittedParts<2>{{constant(0)}, {constant(1)}}; };
  const Values everywhere([](const Point<2>&) { return 1; });
  EXPECT_TRUE(left_out_gaps<2>(with_gap(), everywhere, Fits{any}).empty());
}

}  // namespace
}  // namespace csrbf::left_out_gaps_test
