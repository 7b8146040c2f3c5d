#include "services/bus/write_within.hpp"

#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

using std::chrono::hours;
using std::chrono::nanoseconds;

TEST(WriteWithin, TriesAgainUntilTheHistoryHasRoom) {
  int attempts = 0;
  const WriteOutcome outcome = write_within(hours(1), [&attempts] {
    ++attempts;
    return attempts < 4 ? WriteOutcome::timed_out : WriteOutcome::written;
  });
  EXPECT_EQ(outcome, WriteOutcome::written);
  EXPECT_EQ(attempts, 4);
}

TEST(WriteWithin, DoesNotRepeatWhatFailedForAnotherReason) {
  int attempts = 0;
  const WriteOutcome outcome = write_within(hours(1), [&attempts] {
    ++attempts;
    return WriteOutcome::failed;
  });
  EXPECT_EQ(outcome, WriteOutcome::failed);
  EXPECT_EQ(attempts, 1);
}

TEST(WriteWithin, TriesOnceWhenThereIsNoTime) {
  int attempts = 0;
  const WriteOutcome outcome = write_within(nanoseconds(0), [&attempts] {
    ++attempts;
    return WriteOutcome::timed_out;
  });
  EXPECT_EQ(outcome, WriteOutcome::timed_out);
  EXPECT_EQ(attempts, 1);
}

} // namespace
} // namespace dyncal::bus
