#include "csrbf/linalg/panel_product.hpp"

#include <gtest/gtest.h>

namespace csrbf::panel_product_test {
namespace {

TEST(PanelProduct, AddsTheProductForAnyNumberOfColumns) {
  for (const Index columns : {1, 5, 6, 7, 13}) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::Random(24, 11), B = Eigen::MatrixXd::Random(13, columns);
    const Eigen::MatrixXd before = Eigen::MatrixXd::Random(24, columns);
    Eigen::MatrixXd C = before;
    panel_product(A.data(), 24, 11, B.data(), 13, columns, C.data());
    EXPECT_LT((C - before - A * B.topRows(11)).cwiseAbs().maxCoeff(), 1e-14) << columns;
  }
}

TEST(PanelProduct, GivesAColumnTheSameBitsWhateverItsNeighbours) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(16, 30), B = Eigen::MatrixXd::Random(30, 8);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(16, 8), alone = all;
  panel_product(A.data(), 16, 30, B.data(), 30, 8, all.data());
  for (Index c = 0; c < 8; ++c) panel_product(A.data(), 16, 30, B.col(c).data(), 30, 1, alone.col(c).data());
  EXPECT_EQ(all, alone);
}

TEST(PanelProduct, PadsToWholePanels) {
  EXPECT_EQ(padded_rows(0), 0);
  EXPECT_EQ(padded_rows(1), 8);
  EXPECT_EQ(padded_rows(8), 8);
  EXPECT_EQ(padded_rows(9), 16);
}

}  // namespace
}  // namespace csrbf::panel_product_test
