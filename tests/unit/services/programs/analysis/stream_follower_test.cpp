// A source's messages in order: every way in which some of them are missing, and who is asked when.
#include "services/programs/analysis/stream_follower.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace dyncal::inline programs {
namespace {

using namespace std::chrono_literals;
using Numbers = std::vector<std::uint64_t>;

class StreamFollowerTest : public testing::Test {
protected:
  using Instant = bus::Clock::Instant;

  Instant now_{std::chrono::hours(1)};
  Numbers handed_over_;
  StreamFollower<wire::SampleBlock> follower_{"r1", "asker",
                                              [this](const wire::SampleBlock& block) {
                                                handed_over_.push_back(block.block());
                                                sessions_.push_back(block.session());
                                              }};
  Numbers sessions_;

  static wire::SampleBlock block(std::uint64_t number, std::uint64_t session = 7) {
    wire::SampleBlock one;
    one.session(session);
    one.block(number);
    one.sample_count(1);
    one.values({1.0});
    return one;
  }
  static wire::SampleBlock answer_to(const std::string& run, std::uint64_t number = 0) {
    wire::SampleBlock one = block(number);
    one.sample_count(0);
    one.values({});
    one.acknowledged_run(run);
    return one;
  }
  void live(std::uint64_t number) { follower_.take_live(block(number), now_); }
  void again(std::uint64_t number) { follower_.take_again(block(number), now_); }
  void end_of(const std::string& request) { follower_.take_again(answer_to(request), now_); }
  // Follows the source behind its answer, block 0.
  void begin() { follower_.take_live(answer_to("r1"), now_); }
};

TEST_F(StreamFollowerTest, BeginsWithTheAnswerThatNamesItsRun) {
  live(3);
  follower_.take_live(answer_to("r0", 4), now_);
  EXPECT_FALSE(follower_.answered());
  follower_.take_live(answer_to("r1", 5), now_);
  live(6);
  EXPECT_TRUE(follower_.answered());
  EXPECT_EQ(handed_over_, (Numbers{5, 6}));
  EXPECT_FALSE(follower_.due(now_));
}

TEST_F(StreamFollowerTest, LeavesOutWhatItHasAlready) {
  begin();
  live(1);
  live(1);
  live(0);
  live(2);
  EXPECT_EQ(handed_over_, (Numbers{0, 1, 2}));
  EXPECT_FALSE(follower_.catching_up());
}

TEST_F(StreamFollowerTest, AsksForAGapAndHandsOverInOrder) {
  begin();
  live(1);
  live(4);
  live(5);
  EXPECT_EQ(handed_over_, (Numbers{0, 1}));
  EXPECT_TRUE(follower_.catching_up());
  const auto due = follower_.due(now_);
  ASSERT_TRUE(due);
  EXPECT_EQ(due->request, "asker 1");
  EXPECT_EQ(due->behind, (StreamPosition{7, 1}));
  again(2);
  again(3);
  again(4);
  live(6);
  end_of("asker 1");
  EXPECT_EQ(handed_over_, (Numbers{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_FALSE(follower_.catching_up());
  EXPECT_EQ(follower_.recovered(), 3U);
}

TEST_F(StreamFollowerTest, AcceptsALossThatTheSourceCannotMakeGood) {
  begin();
  live(3);
  again(2); // 1 is gone for good
  end_of("asker 1");
  live(4);
  EXPECT_EQ(handed_over_, (Numbers{0, 2, 3, 4}));
  live(6);
  end_of("asker 2");
  EXPECT_EQ(handed_over_, (Numbers{0, 2, 3, 4, 6}));
  EXPECT_FALSE(follower_.catching_up());
}

TEST_F(StreamFollowerTest, AsksAgainForAGapThatOpenedWhileItWasCatchingUp) {
  begin();
  live(2);
  again(1);
  again(2);
  live(5); // 3 and 4 are missing now
  live(6);
  end_of("asker 1");
  EXPECT_EQ(handed_over_, (Numbers{0, 1, 2}));
  const auto due = follower_.due(now_);
  ASSERT_TRUE(due);
  EXPECT_EQ(due->request, "asker 2");
  EXPECT_EQ(due->behind, (StreamPosition{7, 2}));
  again(3);
  again(4);
  end_of("asker 2");
  EXPECT_EQ(handed_over_, (Numbers{0, 1, 2, 3, 4, 5, 6}));
}

TEST_F(StreamFollowerTest, DoesNotTakeTheEndOfAnotherAnswerForItsOwn) {
  begin();
  live(2);
  end_of("asker 17");
  EXPECT_TRUE(follower_.catching_up());
  EXPECT_EQ(handed_over_, (Numbers{0}));
}

TEST_F(StreamFollowerTest, RepeatsARequestEvery500MillisecondsUntilTheAnswerBegins) {
  begin();
  live(2);
  EXPECT_TRUE(follower_.due(now_));
  now_ += 499ms;
  EXPECT_FALSE(follower_.due(now_));
  now_ += 1ms;
  EXPECT_EQ(follower_.due(now_)->request, "asker 1");
  again(1);
  now_ += 500ms;
  EXPECT_FALSE(follower_.due(now_));
}

TEST_F(StreamFollowerTest, AsksAnewWhenAnAnswerStops) {
  begin();
  live(5);
  EXPECT_TRUE(follower_.due(now_));
  again(1);
  now_ += StreamFollower<wire::SampleBlock>::stall_limit;
  EXPECT_FALSE(follower_.due(now_));
  now_ += 1ns;
  const auto due = follower_.due(now_);
  ASSERT_TRUE(due);
  EXPECT_EQ(due->request, "asker 2");
  EXPECT_EQ(due->behind, (StreamPosition{7, 1}));
}

TEST_F(StreamFollowerTest, FollowsASourceThatSendsButDoesNotAnswerRequests) {
  begin();
  live(3);
  static_cast<void>(follower_.due(now_));
  now_ += StreamFollower<wire::SampleBlock>::answer_limit;
  live(4);
  EXPECT_TRUE(follower_.due(now_));
  EXPECT_EQ(handed_over_, (Numbers{0}));
  now_ += 1ns;
  EXPECT_FALSE(follower_.due(now_));
  EXPECT_EQ(handed_over_, (Numbers{0, 3, 4}));
}

TEST_F(StreamFollowerTest, GoesOnAskingASourceThatIsSilent) {
  begin();
  now_ += StreamFollower<wire::SampleBlock>::silence_limit;
  EXPECT_FALSE(follower_.due(now_));
  now_ += 1ns;
  EXPECT_TRUE(follower_.due(now_));
  for (int i = 0; i < 240; ++i) {
    now_ += 500ms;
    EXPECT_TRUE(follower_.due(now_)) << i;
  }
  again(1); // what it had sent into the void
  end_of("asker 1");
  EXPECT_EQ(handed_over_, (Numbers{0, 1}));
  now_ += StreamFollower<wire::SampleBlock>::silence_limit;
  EXPECT_FALSE(follower_.due(now_));
  now_ += 1ns;
  EXPECT_EQ(follower_.due(now_)->request, "asker 2");
}

TEST_F(StreamFollowerTest, DoesNotAskASourceThatHasEnded) {
  begin();
  wire::SampleBlock end = block(1);
  end.end_of_stream(true);
  follower_.take_live(end, now_);
  EXPECT_TRUE(follower_.ended());
  now_ += 1h;
  EXPECT_FALSE(follower_.due(now_));
}

TEST_F(StreamFollowerTest, FollowsANewSessionFromItsBeginning) {
  begin();
  live(1);
  follower_.take_live(block(0, 8), now_);
  follower_.take_live(block(2, 7), now_); // late, of the session before
  follower_.take_live(block(1, 8), now_);
  EXPECT_EQ(handed_over_, (Numbers{0, 1, 0, 1}));
  EXPECT_EQ(sessions_, (Numbers{7, 7, 8, 8}));
  EXPECT_FALSE(follower_.catching_up());
}

TEST_F(StreamFollowerTest, AsksForTheBeginningOfANewSession) {
  begin();
  follower_.take_live(block(2, 8), now_);
  const auto due = follower_.due(now_);
  ASSERT_TRUE(due);
  EXPECT_EQ(due->behind, (StreamPosition{7, 0}));
  again(1);
  for (const std::uint64_t number : {0, 1, 2}) {
    follower_.take_again(block(number, 8), now_);
  }
  end_of("asker 1");
  EXPECT_EQ(handed_over_, (Numbers{0, 1, 0, 1, 2}));
}

TEST_F(StreamFollowerTest, BegunBehindItAsksForEverythingFromTheAnswerOn) {
  follower_.start_by_catching_up(now_);
  live(9);
  live(10);
  const auto due = follower_.due(now_);
  ASSERT_TRUE(due);
  EXPECT_EQ(due->behind, StreamPosition{});
  follower_.take_again(answer_to("r1", 5), now_);
  for (const std::uint64_t number : {6, 7, 8, 9}) {
    again(number);
  }
  end_of("asker 1");
  EXPECT_EQ(handed_over_, (Numbers{5, 6, 7, 8, 9, 10}));
  EXPECT_TRUE(follower_.answered());
  EXPECT_FALSE(follower_.lacks_beginning());
}

TEST_F(StreamFollowerTest, BegunBehindItNoticesThatTheBeginningIsGone) {
  follower_.start_by_catching_up(now_);
  again(8); // the oldest that the source has
  EXPECT_TRUE(follower_.lacks_beginning());
}

TEST_F(StreamFollowerTest, BegunBehindASourceThatHasNothingItNoticesThatTheBeginningIsGone) {
  follower_.start_by_catching_up(now_);
  end_of("asker 1");
  EXPECT_FALSE(follower_.lacks_beginning());
  live(9);
  EXPECT_TRUE(follower_.lacks_beginning());
}

TEST_F(StreamFollowerTest, ThrowsAwayWhatItCannotHoldAndAsksForIt) {
  begin();
  wire::SampleBlock large = block(2);
  large.values(std::vector<double>(std::size_t{1} << 20U)); // 8 MB
  for (std::uint64_t number = 2; number <= 12; ++number) {
    large.block(number);
    follower_.take_live(large, now_);
  }
  again(1);
  end_of("asker 1");
  EXPECT_EQ(handed_over_, (Numbers{0, 1}));
  EXPECT_EQ(follower_.due(now_)->request, "asker 2");
  for (std::uint64_t number = 2; number <= 12; ++number) {
    again(number);
  }
  end_of("asker 2");
  EXPECT_EQ(handed_over_, (Numbers{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
}

TEST(StreamFollowerOfRecords, TakesShotsInOrderAndEmptyMessagesAsTheyCome) {
  Numbers shots;
  StreamFollower<wire::TriggeredRecord> follower(
      "r1", "asker", [&](const wire::TriggeredRecord& record) { shots.push_back(record.shot()); });
  const bus::Clock::Instant now{std::chrono::hours(1)};
  const auto shot = [](std::uint64_t number) {
    wire::TriggeredRecord record;
    record.session(3);
    record.shot(number);
    record.sample_count(1);
    return record;
  };
  wire::TriggeredRecord answer;
  answer.session(3);
  answer.acknowledged_run("r1");
  follower.take_live(answer, now);
  follower.take_live(shot(1), now);
  follower.take_live(wire::TriggeredRecord(), now);
  follower.take_live(shot(3), now);
  EXPECT_EQ(follower.due(now)->behind, (StreamPosition{3, 1}));
  follower.take_again(shot(2), now);
  wire::TriggeredRecord end;
  end.acknowledged_run("asker 1");
  follower.take_again(end, now);
  EXPECT_EQ(shots, (Numbers{0, 1, 0, 2, 3}));
}

} // namespace
} // namespace dyncal::inline programs
