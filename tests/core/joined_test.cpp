#include "csrbf/core/joined.hpp"

#include <gtest/gtest.h>

namespace csrbf::joined_test {
namespace {

TEST(EditDistance, CountsSlips) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("fit", ""), 3U);
  EXPECT_EQ(edit_distance("kernel", "kernel"), 0U);
  EXPECT_EQ(edit_distance("kernl", "kernel"), 1U);
  EXPECT_EQ(edit_distance("keernel", "kernel"), 1U);
  EXPECT_EQ(edit_distance("kermel", "kernel"), 1U);
  EXPECT_EQ(edit_distance("kernle", "kernel"), 1U);
  EXPECT_EQ(edit_distance("sitting", "kitten"), 3U);
}

TEST(DidYouMean, NamesTheMostSimilarWordIfItIsSimilar) {
  const std::vector<std::string> known = {"fit", "evaluate", "wendland-c2", "wendland-c4"};
  EXPECT_EQ(did_you_mean("evalute", known), "did you mean evaluate? ");
  EXPECT_EQ(did_you_mean("wendlnd-c4", known), "did you mean wendland-c4? ");
  EXPECT_EQ(did_you_mean("ift", known), "did you mean fit? ");
  EXPECT_EQ(did_you_mean("segment", known), "");
  EXPECT_EQ(did_you_mean("ab", known), "");
  EXPECT_EQ(did_you_mean(std::string(1000, 'f'), known), "");
}

}  // namespace
}  // namespace csrbf::joined_test
