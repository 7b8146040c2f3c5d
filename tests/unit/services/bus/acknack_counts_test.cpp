#include "services/bus/fastdds/acknack_counts.hpp"

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

TEST(AcknackCounts, AreThoseOfAReaderThatNeverBeginsAnew) {
  AcknackCounts counts;
  EXPECT_EQ(counts.continued(pair_of(1), 7), 7U);
  EXPECT_EQ(counts.continued(pair_of(1), 7), 7U) << "a packet that came twice";
  EXPECT_EQ(counts.continued(pair_of(1), 6), 6U) << "one that was overtaken";
  EXPECT_EQ(counts.continued(pair_of(1), 8), 8U);
}

TEST(AcknackCounts, GoOnWhereTheReaderBeginsAnew) {
  AcknackCounts counts;
  EXPECT_EQ(counts.begin_anew(pair_of(1)), 1U) << "more than the 0 of no ACKNACK yet";
  EXPECT_EQ(counts.continued(pair_of(1), 1), 2U);
  EXPECT_EQ(counts.continued(pair_of(1), 41), 42U);
  EXPECT_EQ(counts.begin_anew(pair_of(1)), 43U);
  EXPECT_EQ(counts.begin_anew(pair_of(1)), 44U);
  EXPECT_EQ(counts.continued(pair_of(1), 42), 45U);
  EXPECT_EQ(counts.continued(pair_of(2), 5), 5U) << "of another reader";
}

TEST(AcknackCounts, AreOfSoManyPairsAtMost) {
  AcknackCounts counts;
  for (std::uint32_t i = 0; i < AcknackCounts::max_pairs; ++i) {
    EXPECT_EQ(counts.begin_anew(pair_of(i)), 1U);
  }
  EXPECT_EQ(counts.continued(pair_of(0), 5), 6U) << "still known";
  EXPECT_EQ(counts.begin_anew(pair_of(AcknackCounts::max_pairs)), 1U);
  EXPECT_EQ(counts.continued(pair_of(0), 6), 6U) << "forgotten";
}

} // namespace
} // namespace dyncal::bus
