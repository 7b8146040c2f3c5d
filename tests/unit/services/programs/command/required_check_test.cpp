#include "services/programs/command/required_check.hpp"

#include <filesystem>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "services/base/output_file.hpp"
#include "services/records/store/store.hpp"
#include "tests/unit/services/records/store/example_results.hpp"

namespace dyncal::inline programs {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::int64_t hour_ns = 3'600'000'000'000;

class RequiredCheck : public ::testing::Test {
protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / fmt::format("dyncal-required-check-{}", getpid());
    std::filesystem::create_directories(folder_);
    demand_.settings.sensor = "mpu-7";
    demand_.settings.first = 3;
    demand_.store = (folder_ / "store.sqlite").string();
    planned_ = tests::outcome_of({.serial = "customer-1"});
    newest_utc_ns_ = planned_.began_utc_ns;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void keep(const tests::ExampleResult& example) {
    evaluation::RunOutcome outcome = tests::outcome_of(example);
    std::erase_if(outcome.results, [](const StepResult& result) { return !result.valid; });
    outcome.planned_steps = outcome.results.size();
    outcome.interrupted = false;
    outcome.problem.clear();
    for (TransferFunction& function : outcome.transfer_functions) {
      function.flags.clear();
    }
    for (StepResult& result : outcome.results) {
      result.flags.clear();
    }
    keep_outcome(outcome);
  }
  void keep_outcome(const evaluation::RunOutcome& outcome) {
    const std::filesystem::path file = folder_ / (outcome.run + ".json");
    ASSERT_TRUE(write_output_file(file, tests::text_of(outcome)));
    auto store = Store::open(demand_.store);
    ASSERT_TRUE(store) << store.error().message;
    const auto added = (*store)->add(file);
    ASSERT_TRUE(added) << added.error().message;
    newest_utc_ns_ = std::max(newest_utc_ns_, outcome.began_utc_ns);
  }

  [[nodiscard]] Expected<DailyCheck> required(double age_h) const {
    return require_check(demand_, planned_,
                         newest_utc_ns_ + static_cast<std::int64_t>(age_h * hour_ns));
  }
  [[nodiscard]] std::string refusal(double age_h) const {
    const auto check = required(age_h);
    return check ? "" : check.error().message;
  }

  std::filesystem::path folder_;
  CheckDemand demand_;
  evaluation::RunOutcome planned_;
  std::int64_t newest_utc_ns_ = 0;
};

TEST_F(RequiredCheck, RefusesWithoutOneAndSaysWhatToDo) {
  EXPECT_THAT(refusal(0.0),
              AllOf(HasSubstr("sensor 'mpu-7' that is at most 24 h old"),
                    HasSubstr("has no complete one"), HasSubstr("--without-check REASON")));
  demand_.store.clear();
  EXPECT_THAT(refusal(0.0), HasSubstr("without a store"));
}

TEST_F(RequiredCheck, TakesAYoungOneOfThisBench) {
  keep({.run = "c1"});
  const auto check = required(23.9);
  ASSERT_TRUE(check) << check.error().message;
  EXPECT_EQ(check->run, "c1");
  EXPECT_EQ(check->state, "too few results"); // for limits: said, and no reason to stop
  EXPECT_EQ(check->left_out, "");
  EXPECT_THAT(refusal(24.1), HasSubstr("began 24.1 h ago"));
  EXPECT_THAT(refusal(-25.0), HasSubstr("25.0 h after now"));
  planned_.bench = "other";
  EXPECT_THAT(refusal(1.0), HasSubstr("no complete one of this bench"));
}

TEST_F(RequiredCheck, DoesNotTakeAnIncompleteOne) {
  evaluation::RunOutcome outcome = tests::outcome_of({.run = "c1"});
  outcome.interrupted = true;
  keep_outcome(outcome);
  EXPECT_THAT(refusal(1.0), HasSubstr("no complete one"));
}

TEST_F(RequiredCheck, RefusesBeyondTheActionLimits) {
  for (int day = 0; day < 4; ++day) {
    keep({.run = fmt::format("c{}", day), .days = day, .magnitude = 1.0 + 1e-5 * day});
  }
  ASSERT_TRUE(required(1.0)) << refusal(1.0);
  EXPECT_EQ(required(1.0)->state, "in control");
  keep({.run = "off", .days = 5, .magnitude = 1.01});
  EXPECT_THAT(refusal(1.0), AllOf(HasSubstr("run 'off'"), HasSubstr("beyond its action limits"),
                                  HasSubstr("dyncal history mpu-7 --check")));
  demand_.settings.limit_percent = 5.0; // as stated, in place of those by scatter
  demand_.settings.limit_deg = 5.0;
  EXPECT_TRUE(required(1.0)) << refusal(1.0);
}

TEST_F(RequiredCheck, IsLeftOutForAReason) {
  demand_.left_out = "the check sensor is away";
  const auto check = required(0.0);
  ASSERT_TRUE(check) << check.error().message;
  EXPECT_EQ(check->left_out, "the check sensor is away");
  EXPECT_THAT(sentence_of(*check), HasSubstr("left out: the check sensor is away"));
}

TEST_F(RequiredCheck, IsNotAskedOfTheCheckItself) {
  planned_ = tests::outcome_of({.serial = "mpu-7"});
  const auto check = required(0.0);
  ASSERT_TRUE(check) << check.error().message;
  EXPECT_EQ(check->run, "");
  EXPECT_THAT(sentence_of(*check), HasSubstr("This run is of the check sensor"));
}

} // namespace
} // namespace dyncal::inline programs
