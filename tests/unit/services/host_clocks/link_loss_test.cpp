#include "services/host_clocks/link_loss.hpp"

#include <gtest/gtest.h>

namespace dyncal::services {
namespace {

constexpr std::uint64_t series = 7;

ProbeCounts told(std::uint64_t first, std::uint64_t newest, std::uint64_t received,
                 std::uint64_t echoed) {
  return {series, first, newest, received, echoed};
}

void expect_way(const Way& way, std::uint64_t sent, std::uint64_t arrived) {
  EXPECT_EQ(way.sent, sent);
  EXPECT_EQ(way.arrived, arrived);
}

TEST(LinkLoss, CountsFromTheFirstProbeThatCame) {
  const ProbesSent sent{.series = series, .all = 200, .early = 0, .due = 190};
  expect_way(way_there(sent, told(31, 200, 153, 153)), 170, 153);
}

TEST(LinkLoss, CountsWhatMustHaveComeAfterTheNewestThatDid) {
  const ProbesSent sent{.series = series, .all = 200, .early = 0, .due = 190};
  expect_way(way_there(sent, told(1, 100, 100, 100)), 190, 100);
}

TEST(LinkLoss, CountsWhatAProgramMustHaveGotThatGotNothing) {
  const ProbesSent sent{.series = series, .all = 200, .early = 40, .due = 190};
  expect_way(way_there(sent, {}), 150, 0);
  expect_way(way_there(sent, {.series = 8, .first = 1, .newest = 9, .received = 9, .echoed = 9}),
             150, 0);
  expect_way(way_there({.series = series, .all = 20, .early = 20, .due = 0}, {}), 0, 0);
}

TEST(LinkLoss, CountsEchoesFromTheFirstThatCameUpToTheLastThatWasSent) {
  const ProbesSent sent{.series = series, .all = 200, .early = 0, .due = 190};
  const ProbeCounts counts = told(1, 200, 180, 180);
  expect_way(way_back(sent, counts, {.first = 11, .newest = 100, .received = 80}), 170, 80);
  expect_way(way_back(sent, counts, {.first = 1, .newest = 185, .received = 185}), 185, 185);
  expect_way(way_back(sent, counts, {}), 180, 0);
  expect_way(way_back(sent, {}, {}), 0, 0);
}

TEST(LinkLoss, CountsNoEchoAsLostThatWasNotSent) {
  const ProbesSent sent{.series = series, .all = 200, .early = 0, .due = 190};
  expect_way(way_back(sent, told(1, 200, 200, 50), {.first = 1, .newest = 50, .received = 50}), 50,
             50);
}

TEST(LinkLoss, BelievesNoCountsThatCannotBe) {
  const ProbesSent sent{.series = series, .all = 200, .early = 0, .due = 190};
  for (const ProbeCounts& counts :
       {told(1, 201, 200, 200), told(101, 100, 1, 1), told(1, 100, 101, 100), told(1, 100, 90, 91),
        told(1, 100, 0, 0)}) {
    expect_way(way_there(sent, counts), 0, 0);
    expect_way(way_back(sent, counts, {}), 0, 0);
  }
}

TEST(LinkLoss, StatesNoPartOfAFew) {
  EXPECT_FALSE(lost_part({.sent = fewest_probes - 1, .arrived = 0}));
  EXPECT_EQ(lost_part({.sent = 200, .arrived = 150}), 0.25);
  EXPECT_EQ(lost_part({.sent = 200, .arrived = 0}), 1.0);
  EXPECT_EQ(lost_part({.sent = 200, .arrived = 200}), 0.0);
}

} // namespace
} // namespace dyncal::services
