#include "services/records/capture/source_gaps.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline records::recording {
namespace {

using namespace std::chrono_literals;

const SourceGaps::Instant start{std::chrono::hours(1)};

TEST(SourceGaps, AskForWhatAJumpLeftOut) {
  SourceGaps gaps("me");
  EXPECT_TRUE(gaps.take_live({7, 0}, start));
  EXPECT_TRUE(gaps.take_live({7, 1}, start));
  EXPECT_FALSE(gaps.due(start));
  EXPECT_TRUE(gaps.take_live({7, 5}, start));
  EXPECT_EQ(gaps.missing(), 3U);
  const auto request = gaps.due(start);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->session, 7U);
  EXPECT_EQ(request->number, 1U);
  EXPECT_FALSE(gaps.due(start + 100ms)) << "asked again only after a while";
  EXPECT_TRUE(gaps.due(start + 600ms));
  EXPECT_TRUE(gaps.take_again(7, 2, start + 1s));
  EXPECT_TRUE(gaps.take_again(7, 3, start + 1s));
  EXPECT_TRUE(gaps.take_again(7, 4, start + 1s));
  EXPECT_FALSE(gaps.take_again(7, 5, start + 1s)) << "it is there";
  gaps.end_of_answer(request->name);
  EXPECT_EQ(gaps.missing(), 0U);
  EXPECT_EQ(gaps.recovered(), 3U);
  EXPECT_EQ(gaps.messages(), 6U);
  EXPECT_FALSE(gaps.due(start + 10s));
}

TEST(SourceGaps, CountAsMissingWhatTheSourceDoesNotGive) {
  SourceGaps gaps("me");
  gaps.take_live({7, 0}, start);
  gaps.take_live({7, 10}, start);
  EXPECT_TRUE(gaps.due(start));
  EXPECT_FALSE(gaps.due(start + SourceGaps::answer_limit + 1s));
  EXPECT_EQ(gaps.missing(), 9U);
}

TEST(SourceGaps, StoreNoMessageTwice) {
  SourceGaps gaps("me");
  EXPECT_TRUE(gaps.take_live({7, 3}, start));
  EXPECT_FALSE(gaps.take_live({7, 3}, start));
  EXPECT_TRUE(gaps.take_live({8, 3}, start));
}

// Blocks count from 0, shots from 1.
TEST(SourceGaps, AskForTheBeginningOfTheNextSession) {
  for (const std::uint64_t first_number : {0, 1}) {
    SourceGaps gaps("me");
    gaps.take_live({7, 5, first_number}, start);
    gaps.take_live({8, first_number, first_number}, start);
    EXPECT_FALSE(gaps.due(start)) << "it came from its beginning";
    gaps.take_live({9, first_number + 1, first_number}, start);
    EXPECT_EQ(gaps.missing(), 1U);
    const auto request = gaps.due(start);
    ASSERT_TRUE(request);
    EXPECT_EQ(request->session, 8U);
    EXPECT_EQ(request->number, first_number);
    EXPECT_TRUE(gaps.take_again(9, first_number, start));
    gaps.end_of_answer(request->name);
    EXPECT_EQ(gaps.missing(), 0U);
    EXPECT_FALSE(gaps.due(start + 10s));
  }
}

// Whoever begins to listen in the middle misses nothing of what was before, as long as nobody asks.
TEST(SourceGaps, DoNotMissWhatWasBeforeTheFirstMessage) {
  SourceGaps gaps("me");
  gaps.take_live({7, 100, 0}, start);
  EXPECT_FALSE(gaps.due(start));
  EXPECT_EQ(gaps.missing(), 0U);
}

TEST(SourceGaps, AskForTheBeginningOfARun) {
  SourceGaps gaps("me");
  gaps.take_live({7, 100}, start);
  gaps.ask_for_all(start);
  const auto request = gaps.due(start);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->session, 0U);
  for (std::uint64_t number = 90; number < 100; ++number) {
    EXPECT_TRUE(gaps.take_again(7, number, start));
  }
  EXPECT_EQ(gaps.missing(), 0U);
  EXPECT_EQ(gaps.recovered(), 10U);
}

} // namespace
} // namespace dyncal::inline records::recording
