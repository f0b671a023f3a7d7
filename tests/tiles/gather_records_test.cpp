#include "csrbf/tiles/stages/gather_records.hpp"

#include "csrbf/tiles/stages/deal_records.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <random>
#include <set>

namespace csrbf::gather_records_test {
namespace {

// Points in the unit square, but for a hole, each with its number.
RecordSource<2> square(Index n, double hole) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  Records<2> all;
  all.each = sizeof(Index);
  while (all.size() < n) {
    const Point<2> p(uniform(random), uniform(random));
    if ((p - Point<2>(0.25, 0.5)).cwiseAbs().maxCoeff() < hole) continue;
    const Index number = all.size();
    all.add(p, {reinterpret_cast<const char*>(&number), sizeof number});
  }
  return {.size = n, .payload = all.each, .read = [all](Index begin, Index end) {
            Records<2> part;
            part.each = all.each;
            for (Index i = begin; i < end; ++i) part.add(all.matrix().col(i), all.payload_of(i));
            return part;
          }};
}

class GatherRecords : public testing::Test {
 protected:
  void make(double hole) {
    source_ = square(20000, hole);
    const TileRules rules{.tile_points = 5000,
                          .dimension = 2,
                          .blend = [](double spacing, double) { return 3 * spacing; },
                          .reach = 5,
                          .boxed = true};
    work_ = plan_work<2>(survey_records<2>(source_, 0, 1, {}), rules, 1);
    work_.payload = source_.payload;
    deal_records<2>(source_, work_, folder_, 0, {});
    for (Index t = 0; t < work_.plan.size(); ++t) sort_records<2>(work_, folder_, t);
  }
  void TearDown() override { folder_.remove("work"); }

  // One for each test: they may run at the same time.
  static std::string path() {
    return testing::TempDir() + "gather_records_" + testing::UnitTest::GetInstance()->current_test_info()->name();
  }

  TileFolder folder_{path()};
  RecordSource<2> source_;
  TileWork<2> work_;
};

TEST_F(GatherRecords, NearPointsAreAllUpToTheHaloWithWhatBelongsToThem) {
  make(0);
  ASSERT_EQ(work_.plan.size(), 4);
  const Records<2> all = source_.read(0, source_.size);
  for (Index tile = 0; tile < 4; ++tile) {
    const Records<2> near = gather_near(work_, folder_, tile);
    const Box<2> wide = work_.plan.box(tile).inflated(work_.halo);
    Index expected = 0;
    for (Index i = 0; i < all.size(); ++i) expected += wide.contains(all.matrix().col(i)) ? 1 : 0;
    EXPECT_EQ(near.size(), expected);
    for (Index i = 0; i < near.size(); i += 97) {
      Index number = 0;
      std::memcpy(&number, near.payload_of(i).data(), sizeof number);
      EXPECT_EQ(near.matrix().col(i), all.matrix().col(number));
    }
  }
}

TEST_F(GatherRecords, CoordinatesThatAreFloatsTakeHalfTheBytes) {
  const ThinningGrid<2> grid = ThinningGrid<2>::over({Point<2>(0, 0), Point<2>(1, 1)}, 0.01);
  const std::string path = folder_.file("points", 0);
  std::array<std::uintmax_t, 2> sizes{};
  for (const bool narrow : {false, true}) {
    Records<2> records = square(10000, 0).read(0, 10000);
    if (narrow)
      for (double& x : records.points) x = static_cast<float>(x);
    write_tile(path, records, thin<2>(records.matrix(), grid));
    sizes[narrow ? 1 : 0] = std::filesystem::file_size(path);
    for (int level = 0; level < grid.levels(); ++level) {
      Records<2> read;
      read.each = records.each;
      const auto all = [](const auto&) { return true; };
      read_tile<2>(path, level, all, all, read);
      EXPECT_EQ(read.size() == records.size(), level == 0);
      for (Index i = 0; i < read.size(); ++i) {
        Index number = 0;
        std::memcpy(&number, read.payload_of(i).data(), sizeof number);
        ASSERT_EQ(read.matrix().col(i), records.matrix().col(number));
      }
    }
  }
  EXPECT_LT(sizes[1], sizes[0] - 2 * sizeof(float) * 10000);
}

TEST_F(GatherRecords, SurveysOfPartsAreThatOfTheWhole) {
  make(0);
  const Survey<2> whole = survey_records<2>(source_, 0, 1, {});
  for (const Index parts : {2, 7}) {
    Survey<2> sum;
    for (Index part = 0; part < parts; ++part) {
      const std::string file = folder_.file("survey", part);
      write_survey(file, survey_records<2>(source_, part, parts, {}));
      add_survey(read_survey<2>(file), sum);
    }
    EXPECT_EQ(sum.points, whole.points);
    EXPECT_EQ(sum.non_finite, whole.non_finite);
    EXPECT_EQ(sum.bounds.lo, whole.bounds.lo);
    EXPECT_EQ(sum.bounds.hi, whole.bounds.hi);
    EXPECT_EQ(sum.sample, whole.sample);
  }
}

TEST_F(GatherRecords, FarPointsAreFewAndEverywhere) {
  make(0);
  Records<2> records = gather_near(work_, folder_, 0);
  const Index near = records.size();
  add_far(work_, folder_, 0, records);
  EXPECT_GT(records.size(), near);
  EXPECT_LT(records.size(), 10000);
  const Box<2> seen = bounding_box<2>(records.matrix());
  EXPECT_LT((seen.lo - work_.bounds.lo).norm() + (seen.hi - work_.bounds.hi).norm(), 0.3);
}

TEST_F(GatherRecords, GapsAreCubesAsWideAsTheHalo) {
  make(0);
  for (Index tile = 0; tile < 4; ++tile) EXPECT_FALSE(has_gaps(work_, tile, gather_near(work_, folder_, tile)));
  folder_.remove("work");
  folder_ = TileFolder(path());
  make(0.2);
  EXPECT_TRUE(has_gaps(work_, work_.plan.tile_of(Point<2>(0.25, 0.5)),
                       gather_near(work_, folder_, work_.plan.tile_of(Point<2>(0.25, 0.5)))));
  EXPECT_FALSE(has_gaps(work_, work_.plan.tile_of(Point<2>(0.95, 0.95)),
                        gather_near(work_, folder_, work_.plan.tile_of(Point<2>(0.95, 0.95)))));
}

TEST_F(GatherRecords, ThinnedPointsAreNoMoreThanAskedFor) {
  make(0);
  const Index n = thinned_records(work_, folder_, 3000).size();
  EXPECT_LE(n, 3000);
  EXPECT_GT(n, 500);
}

}  // namespace
}  // namespace csrbf::gather_records_test
