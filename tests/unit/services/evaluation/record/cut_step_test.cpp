#include "services/evaluation/record/cut_step.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr std::int64_t ms = 1'000'000;

// Steps of 0.2 s and 1 s, excited 0.4 s longer, every 2 s from 1 s on; of the first, what a record
// that begins `cut_ms` after its beginning holds.
class CutStep : public testing::Test {
protected:
  void SetUp() override {
    step_.settling_s = 0.2;
    step_.duration_s = 1.0;
  }
  static FoundExcitation found(std::int64_t begin_ms, std::int64_t end_ms) {
    FoundExcitation one{.frame_ns = 50 * ms};
    one.window.excited_begin_ns = begin_ms * ms;
    one.window.begin_ns = begin_ms * ms;
    one.window.end_ns = one.window.off_ns = end_ms * ms;
    return one;
  }
  [[nodiscard]] std::optional<TimeInterval> evaluated(std::int64_t cut_ms,
                                                      std::int64_t last_end_ms = 6600) const {
    RecordedExcitations record{.channel = "dau/sync", .source = "dau"};
    record.found = {found(1000 + cut_ms, 2600), found(3000, 4600), found(5000, last_end_ms)};
    record.recorded = {(1000 + cut_ms) * ms, 7000 * ms};
    const std::vector<const RecipeStep*> steps(3, &step_);
    return evaluated_of_cut_step(record, steps);
  }
  RecipeStep step_{.frequency_text_hz = "80", .frequency = analysis::Frequency::from_hz(80.0)};
};

TEST_F(CutStep, TakesWhatLiesWithinTheEvaluatedPartForSure) {
  const auto part = evaluated(300); // of 1200 to 2200 ms
  ASSERT_TRUE(part);
  EXPECT_EQ(part->begin_ns, 1300 * ms);
  EXPECT_EQ(part->end_ns, (2200 - 65) * ms - 1); // 1.3 frames
}

TEST_F(CutStep, LeavesTheSettlingOutThatIsThere) {
  const auto part = evaluated(110);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->begin_ns, (1200 + 65) * ms);
}

TEST_F(CutStep, HasNothingWhereOnlyWhatIsBehindItIsThere) {
  const auto part = evaluated(1250);
  ASSERT_TRUE(part);
  EXPECT_LT(part->end_ns, part->begin_ns);
}

TEST_F(CutStep, IsNoneWhereItsBeginningIsThere) {
  EXPECT_FALSE(evaluated(0));
  EXPECT_FALSE(evaluated(50));
}

TEST_F(CutStep, IsNoneWhereTheOthersLastAsLongAsTheyLike) {
  EXPECT_FALSE(evaluated(300, 6990 - 900));
}

} // namespace
} // namespace dyncal::inline evaluation
