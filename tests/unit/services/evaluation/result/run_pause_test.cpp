// What counts as one pause, and what as another.
#include "services/evaluation/result/run_pause.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline evaluation {
namespace {

constexpr const char* silent = "source 'dau' has sent nothing for 5 s";

TEST(RunPause, LastsAsLongAsItsReasonWhateverTheNumbersInIt) {
  std::vector<RunPause> pauses;
  note_pause(pauses, 10, silent);
  note_pause(pauses, 11, "source 'dau' has sent nothing for 6 s");
  end_pause(pauses, 20);
  ASSERT_EQ(pauses.size(), 1U);
  EXPECT_EQ(pauses[0].began_utc_ns, 10);
  EXPECT_EQ(pauses[0].ended_utc_ns, 20);
  EXPECT_EQ(pauses[0].reason, silent);
}

TEST(RunPause, EndsWhereAnotherReasonBegins) {
  std::vector<RunPause> pauses;
  note_pause(pauses, 10, silent);
  note_pause(pauses, 15, "the service of source 'dau' has read another bench file");
  ASSERT_EQ(pauses.size(), 2U);
  EXPECT_EQ(pauses[0].ended_utc_ns, 15);
  EXPECT_EQ(pauses[1].began_utc_ns, 15);
  EXPECT_EQ(pauses[1].ended_utc_ns, 0);
}

TEST(RunPause, IsAnotherOneForTheSameReasonOnceTheRunHasGoneOn) {
  std::vector<RunPause> pauses;
  end_pause(pauses, 5);
  EXPECT_TRUE(pauses.empty());
  note_pause(pauses, 10, silent);
  end_pause(pauses, 20);
  end_pause(pauses, 25);
  note_pause(pauses, 30, silent);
  ASSERT_EQ(pauses.size(), 2U);
  EXPECT_EQ(pauses[0].ended_utc_ns, 20);
}

} // namespace
} // namespace dyncal::inline evaluation
