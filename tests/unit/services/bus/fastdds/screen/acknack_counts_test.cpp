#include "services/bus/fastdds/screen/acknack_counts.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

AcknackCounts::Pair pair_of(std::uint32_t number) {
  std::vector<unsigned char> source(12, 0);
  for (int i = 0; i < 4; ++i) {
    source[static_cast<std::size_t>(i)] = static_cast<unsigned char>(number >> (8 * i));
  }
  return AcknackCounts::pair(source, std::vector<unsigned char>{0, 0, 1, 7, 0, 0, 1, 2});
}

class AcknackCountsTest : public testing::Test {
protected:
  AcknackCounts counts_;
  AcknackCounts::Instant now_;

  std::uint32_t continued(std::uint32_t pair, std::uint32_t count) {
    const auto passed = counts_.continued(pair_of(pair), {.base = 1, .count = count}, now_);
    EXPECT_FALSE(passed.begins_anew);
    return passed.count;
  }
  bool asking_begins_anew(std::int64_t base, std::uint32_t count) {
    const auto passed =
        counts_.continued(pair_of(1), {.base = base, .asks = true, .count = count}, now_);
    EXPECT_EQ(passed.count, count);
    return passed.begins_anew;
  }
  std::optional<std::uint32_t> begin_anew(std::uint32_t pair) {
    return counts_.begin_anew(pair_of(pair), now_);
  }
  void wait(std::chrono::milliseconds time) { now_ += time; }
};

TEST_F(AcknackCountsTest, AreThoseOfAReaderThatNeverBeginsAnew) {
  EXPECT_EQ(continued(1, 7), 7U);
  EXPECT_EQ(continued(1, 7), 7U) << "a packet that came twice";
  EXPECT_EQ(continued(1, 6), 6U) << "one that was overtaken";
  EXPECT_EQ(continued(1, 8), 8U);
}

TEST_F(AcknackCountsTest, GoOnWhereTheReaderBeginsAnew) {
  EXPECT_EQ(begin_anew(1), 1U) << "more than the 0 of no ACKNACK yet";
  EXPECT_EQ(continued(1, 1), 2U);
  EXPECT_EQ(continued(1, 41), 42U);
  wait(AcknackCounts::min_silence);
  EXPECT_EQ(begin_anew(1), 43U);
  wait(AcknackCounts::min_interval);
  EXPECT_EQ(begin_anew(1), 44U);
  EXPECT_EQ(continued(1, 42), 45U);
  EXPECT_EQ(continued(2, 5), 5U) << "of another reader";
}

TEST_F(AcknackCountsTest, DoNotBelieveThatAReaderBeginsAnewWhileItGoesOn) {
  EXPECT_EQ(begin_anew(1), 1U);
  EXPECT_FALSE(begin_anew(1)) << "a copy";
  EXPECT_EQ(continued(1, 1), 2U);
  wait(AcknackCounts::min_silence / 2);
  EXPECT_FALSE(begin_anew(1));
  EXPECT_EQ(continued(1, 2), 3U);
  wait(AcknackCounts::min_silence / 2);
  EXPECT_FALSE(begin_anew(1));
  EXPECT_EQ(continued(1, 1), 2U) << "an old one is no sign of life";
  wait(AcknackCounts::min_silence / 2);
  EXPECT_EQ(begin_anew(1), 4U);
}

TEST_F(AcknackCountsTest, TakeAReaderThatAsksForWhatItHadForOneThatBeginsAnew) {
  EXPECT_FALSE(asking_begins_anew(1, 1));
  EXPECT_FALSE(asking_begins_anew(5, 2));
  EXPECT_FALSE(asking_begins_anew(5, 3)) << "still the same";
  EXPECT_FALSE(asking_begins_anew(4, 2)) << "overtaken by the others";
  EXPECT_TRUE(asking_begins_anew(1, 4));
  EXPECT_FALSE(asking_begins_anew(1, 5)) << "told once: it gets them now";
  EXPECT_FALSE(asking_begins_anew(7, 6));
  EXPECT_FALSE(asking_begins_anew(1, 7)) << "too soon again";
  wait(AcknackCounts::min_interval);
  EXPECT_TRUE(asking_begins_anew(1, 8));
}

TEST_F(AcknackCountsTest, LetAReaderAskForWhatItNeverHad) {
  EXPECT_EQ(continued(1, 1), 1U);
  EXPECT_FALSE(asking_begins_anew(1, 2));
  EXPECT_FALSE(asking_begins_anew(3, 3));
  EXPECT_FALSE(asking_begins_anew(3, 4));
}

// Each packet with a changed sender is one.
TEST_F(AcknackCountsTest, NewcomersDoNotMakeThemForgetTheKnown) {
  EXPECT_EQ(begin_anew(0), 1U);
  EXPECT_EQ(continued(0, 5), 6U);
  for (std::uint32_t i = 1; i < 2 * AcknackCounts::max_newcomers; ++i) {
    EXPECT_EQ(begin_anew(i), 1U);
  }
  EXPECT_EQ(continued(0, 6), 7U);
}

TEST_F(AcknackCountsTest, AreOfSoManyPairsAtMost) {
  for (std::uint32_t i = 0; i < AcknackCounts::max_known; ++i) {
    EXPECT_EQ(begin_anew(i), 1U);
    EXPECT_EQ(continued(i, 1), 2U);
  }
  EXPECT_EQ(continued(0, 5), 6U) << "still known";
  EXPECT_EQ(begin_anew(AcknackCounts::max_known), 1U);
  EXPECT_EQ(continued(AcknackCounts::max_known, 1), 2U);
  EXPECT_EQ(continued(0, 6), 6U) << "forgotten";
}

} // namespace
} // namespace dyncal::bus
