#include "drivers/smartup/sync_join.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace dyncal::drivers::smartup {
namespace {

SampleRow row(std::uint64_t sample, std::int64_t stamp_ns) {
  SampleRow row;
  row.sample = sample;
  row.stamp_ns = stamp_ns;
  row.present = 1;
  return row;
}

void add_sync(SyncJoin& join, std::int64_t stamp_ns) {
  join.add_sync(stamp_ns, 1, {static_cast<float>(stamp_ns)});
}

std::vector<SampleRow> taken(SyncJoin& join) {
  std::vector<SampleRow> rows;
  SampleRow next;
  while (join.take(next)) {
    rows.push_back(next);
  }
  return rows;
}

TEST(SyncJoin, JoinsByStampInEitherOrder) {
  SyncJoin join;
  join.add(row(1, 100));
  EXPECT_TRUE(taken(join).empty());
  add_sync(join, 100);
  add_sync(join, 200);
  join.add(row(2, 200));
  const auto rows = taken(join);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].sync_values[0], 100.0F);
  EXPECT_EQ(rows[1].sync_values[0], 200.0F);
  EXPECT_EQ(join.without_sync(), 0U);
}

TEST(SyncJoin, GoesOnWithoutAPartnerThatWasLost) {
  SyncJoin join;
  join.add(row(1, 100));
  join.add(row(2, 200));
  add_sync(join, 200);
  const auto rows = taken(join);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].sync_present, 0U);
  EXPECT_EQ(rows[1].sync_values[0], 200.0F);
  EXPECT_EQ(join.without_sync(), 1U);
}

TEST(SyncJoin, LeavesOutASyncSampleWhoseSensorSampleWasLost) {
  SyncJoin join;
  add_sync(join, 100);
  add_sync(join, 200);
  join.add(row(2, 200));
  const auto rows = taken(join);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].sync_values[0], 200.0F);
  EXPECT_EQ(join.sync_left_out(), 1U);
}

TEST(SyncJoin, RepeatedStampsAreJoinedInOrder) {
  SyncJoin join;
  for (std::uint64_t n = 1; n <= 2; ++n) {
    join.add(row(n, 100));
  }
  join.add_sync(100, 1, {1.0F});
  join.add_sync(100, 1, {2.0F});
  const auto rows = taken(join);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].sync_values[0], 1.0F);
  EXPECT_EQ(rows[1].sync_values[0], 2.0F);
}

TEST(SyncJoin, WaitsNoLongerThanItsBound) {
  SyncJoin join;
  for (std::uint64_t n = 1; n <= SyncJoin::max_wait; ++n) {
    join.add(row(n, static_cast<std::int64_t>(n)));
  }
  EXPECT_TRUE(taken(join).empty());
  join.add(row(SyncJoin::max_wait + 1, 5000));
  EXPECT_EQ(taken(join).size(), 1U);
  for (int i = 0; i < 3000; ++i) {
    add_sync(join, -i);
  }
  EXPECT_GE(join.sync_left_out(), 3000U - SyncJoin::max_wait);
}

TEST(SyncJoin, ReleasesEverythingAtTheEnd) {
  SyncJoin join;
  join.add(row(1, 100));
  join.add(row(2, 200));
  join.release();
  EXPECT_EQ(taken(join).size(), 2U);
}

} // namespace
} // namespace dyncal::drivers::smartup
