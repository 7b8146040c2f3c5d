#include "services/contract/duplicate_source_detector.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace dyncal::inline contract {
namespace {

DuplicateSourceDetector watch(const std::vector<std::uint64_t>& sessions) {
  DuplicateSourceDetector twins;
  for (const std::uint64_t session : sessions) {
    twins.add(session);
  }
  return twins;
}

TEST(DuplicateSourceDetector, TakesNewSessionsForRestarts) {
  EXPECT_FALSE(watch({7, 7, 7}).twins());
  EXPECT_FALSE(watch({7, 7, 8, 8, 9, 10}).twins());
}

TEST(DuplicateSourceDetector, LetsTheLastBlocksOfTheSessionBeforeComeLate) {
  EXPECT_FALSE(watch({7, 8, 7, 7}).twins());
}

TEST(DuplicateSourceDetector, SeesSessionsThatTakeTurns) {
  EXPECT_TRUE(watch({7, 8, 7, 8}).twins());
  EXPECT_TRUE(watch({7, 7, 8, 8, 8, 7, 8}).twins());
}

TEST(DuplicateSourceDetector, SeesATwinOfASourceThatHasRestarted) {
  EXPECT_TRUE(watch({7, 8, 7, 9, 7, 9, 7}).twins());
}

TEST(DuplicateSourceDetector, ForgetsATwinWhenTheOtherHasComeAloneForLong) {
  DuplicateSourceDetector twins(4);
  for (const std::uint64_t session : {7U, 8U, 7U, 8U, 8U, 8U}) {
    twins.add(session);
  }
  EXPECT_TRUE(twins.twins());
  twins.add(8);
  EXPECT_FALSE(twins.twins());
  twins.add(7); // not a return: a restart may come at any time
  EXPECT_FALSE(twins.twins());
}

} // namespace
} // namespace dyncal::inline contract
