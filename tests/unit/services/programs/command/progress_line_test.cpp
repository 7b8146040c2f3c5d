#include "services/programs/command/progress_line.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

TEST(ProgressLine, SaysStepFrequencyPhaseAndTimeLeft) {
  RunProgress progress;
  progress.step = 7;
  progress.steps = 51;
  progress.frequency_hz = "40";
  progress.phase = "settling";
  EXPECT_EQ(describe(progress), "step 7 of 51, 40 Hz, settling");
  progress.seconds_left = 37.2;
  EXPECT_EQ(describe(progress), "step 7 of 51, 40 Hz, settling, 38 s left");
}

TEST(ProgressLine, SaysBeforeTheFirstStepWhatIsWaitedFor) {
  RunProgress progress;
  progress.steps = 51;
  progress.phase = "waiting for the analysis";
  EXPECT_EQ(describe(progress), "51 steps planned, waiting for the analysis, 0 results");
}

} // namespace
} // namespace dyncal::inline programs
