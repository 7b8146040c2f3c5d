#include "services/evaluation/record/shot_record.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

TriggeredRecord record_of_shot(std::uint64_t shot, std::uint32_t step = 1) {
  return {.session = 9,
          .shot = shot,
          .step = step,
          .samples = 3,
          .channels = 1,
          .interval_s = 1e-3,
          .values = {1.0, 2.0, 3.0}};
}

TEST(ShotRecord, PairsTraceAndSeriesOfOneShot) {
  ShotRecord record;
  record.add_trace(record_of_shot(1));
  record.add_series(record_of_shot(2));
  EXPECT_TRUE(record.of_step({1}).empty());
  record.add_series(record_of_shot(1));
  ASSERT_EQ(record.of_step({1}).size(), 1U);
  EXPECT_EQ(record.of_step({1})[0].series->shot, 1U);
  EXPECT_TRUE(record.of_step({2}).empty());
}

TEST(ShotRecord, CountsForItsStepWhatCannotBeUsed) {
  ShotRecord record;
  TriggeredRecord half = record_of_shot(1, 7);
  half.values.pop_back();
  record.add_series(half);
  TriggeredRecord not_a_number = record_of_shot(2, 7);
  not_a_number.values[1] = std::nan("");
  record.add_trace(not_a_number);
  record.add_trace({.session = 9, .step = 7}); // an answer has no samples: nothing is lost
  const ShotRecord::Losses lost = record.lost_in({7});
  EXPECT_EQ(lost.series.records, 1U);
  EXPECT_EQ(lost.series.unusable_samples, 3U);
  EXPECT_EQ(lost.traces.records, 1U);
  EXPECT_EQ(record.lost_in({1}).traces.records, 0U);
}

TEST(ShotRecord, IsBoundedAndCountsWhatItDrops) {
  ShotRecord record;
  for (std::uint64_t shot = 0; shot < ShotRecord::capacity + 5; ++shot) {
    record.add_series(record_of_shot(shot));
  }
  EXPECT_EQ(record.lost_in({1}).series.records, 5U);
  EXPECT_EQ(record.lost_in({1}).series.overflowed_samples, 15U);
  record.forget_step({1});
  EXPECT_EQ(record.lost_in({1}).series.records, 0U);
  record.add_series(record_of_shot(1));
  record.add_trace(record_of_shot(1));
  EXPECT_EQ(record.of_step({1}).size(), 1U);
}

} // namespace
} // namespace dyncal::inline evaluation
