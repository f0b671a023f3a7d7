#include "csrbf/linalg/gram.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

namespace csrbf::gram_test {
namespace {

constexpr double rounding = 1e-13;

TEST(Gram, OfSmallIntegersIsExact) {
  Eigen::MatrixXd B(4, 2), A = Eigen::MatrixXd::Constant(2, 2, -1);
  B << 1, 5, 2, 6, 3, 7, 4, 8;
  gram(B.data(), 4, 2, A.data());
  EXPECT_EQ(A(0, 0), 30);
  EXPECT_EQ(A(1, 0), 70);
  EXPECT_EQ(A(1, 1), 174);
  EXPECT_EQ(A(0, 1), -1);  // the upper triangle is left alone
}

TEST(Gram, AgreesWithTheProductForEverySize) {
  std::srand(1);
  for (Index n = 1; n <= 34; ++n)
    for (const Index rows : {Index{4}, Index{8}, Index{12}, Index{40}, Index{512}}) {
      const Eigen::MatrixXd B = Eigen::MatrixXd::Random(rows, n), expected = B.transpose() * B;
      Eigen::MatrixXd A = Eigen::MatrixXd::Constant(n, n, 7);
      gram(B.data(), rows, n, A.data());
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i)
          if (i >= j) {
            EXPECT_NEAR(A(i, j), expected(i, j), rounding * static_cast<double>(rows));
          } else {
            EXPECT_EQ(A(i, j), 7);
          }
    }
}

TEST(Gram, OfTwoMatricesAgreesWithTheProductForEverySize) {
  std::srand(2);
  for (Index n = 1; n <= 13; ++n)
    for (Index m = 1; m <= 11; ++m) {
      const Index rows = 4 * n;
      const Eigen::MatrixXd B = Eigen::MatrixXd::Random(rows, n), C = Eigen::MatrixXd::Random(rows, m);
      Eigen::MatrixXd A = Eigen::MatrixXd::Constant(n, m, 7);
      gram(B.data(), n, C.data(), m, rows, A.data());
      EXPECT_LT((A - B.transpose() * C).cwiseAbs().maxCoeff(), rounding * static_cast<double>(rows));
    }
}

TEST(Gram, OfNoRowsIsZero) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Constant(5, 5, 3);
  gram(nullptr, 0, 5, A.data());
  EXPECT_EQ(A.triangularView<Eigen::Lower>().toDenseMatrix(), Eigen::MatrixXd::Zero(5, 5));
}

}  // namespace
}  // namespace csrbf::gram_test
