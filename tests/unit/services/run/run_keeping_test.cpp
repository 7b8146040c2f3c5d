// What a run tells whoever keeps its results, and that it excites nothing where they cannot be
// kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/run/run_controller.hpp"
#include "tests/unit/services/run/played_analysis.hpp"
#include "tests/unit/services/run/played_generator.hpp"
#include "tests/unit/services/run/two_steps.hpp"

namespace dyncal::inline run {
namespace {

using namespace std::chrono_literals;

class RunKeepingTest : public testing::Test {
protected:
  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  tests::PlayedAnalysis analysis_{network_, "b", "r1"};
  bus::Participant participant_ = network_.join("runner");
  tests::PlayedInstrument instrument_{clock_};
  std::stop_source stop_;

  Expected<RunOutcome> conduct(RunKeeping keeping) {
    const BenchFile bench = tests::bench_of_two_steps("b");
    clock_.at(100ms, [this] { analysis_.report(wire::ARM_ARMED); });
    clock_.every(1s, [this] {
      if (!finished_) {
        analysis_.report(wire::ARM_ARMED);
      }
    });
    RunController controller({participant_, clock_, tests::connect_to(instrument_)}, bench, "r1",
                             [](const RunProgress& /*progress*/) {});
    controller.set_keeping(std::move(keeping));
    return controller.conduct({}, stop_.get_token());
  }

  bool finished_ = false;
};

TEST_F(RunKeepingTest, ExcitesNothingWhereResultsCannotBeKept) {
  const auto outcome = conduct({.check = [](const RunOutcome& planned) -> Expected<void> {
                                  EXPECT_EQ(planned.planned_steps, 2U);
                                  return fail(ErrorCode::bad_file, "/data: the disk is full");
                                },
                                .keep = {}});
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().message, "/data: the disk is full");
  EXPECT_TRUE(instrument_.settings.empty());
  EXPECT_EQ(analysis_.measurements().back().state(), wire::MEASUREMENT_ABORTED);
}

TEST_F(RunKeepingTest, HandsOverResultsAsTheyCome) {
  std::vector<std::size_t> kept;
  clock_.at(8s, [this] { analysis_.publish_result(1); });
  clock_.at(10s, [this] {
    analysis_.publish_result(2);
    analysis_.publish_transfer_function("dau/acceleration_x");
    finished_ = true;
    analysis_.report(wire::ARM_FINISHED);
  });
  const auto outcome =
      conduct({.check = {}, .keep = [&](const RunOutcome& so_far) {
                 kept.push_back(so_far.results.size() + so_far.transfer_functions.size());
               }});
  ASSERT_TRUE(outcome) << outcome.error().message;
  ASSERT_FALSE(kept.empty());
  EXPECT_EQ(kept.front(), 1U);
  EXPECT_EQ(kept.back(), 3U);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
}

} // namespace
} // namespace dyncal::inline run
