#include "services/stream/retransmission_buffer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"

namespace dyncal::inline stream {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

class RetransmissionBufferTest : public testing::Test {
protected:
  static constexpr std::size_t message_bytes = 100'000;
  static constexpr std::uint64_t session = 7;

  KeptLimits limits() const {
    return {.span = 600s,
            .memory_bytes = 1 << 20U,
            .max_memory_bytes = 8 << 20U,
            .file_bytes = 64 << 20U,
            .min_free_bytes = 0,
            .folder = folder_.path()};
  }
  KeptLimits with_little_room() const {
    KeptLimits small = limits();
    small.span = 20s;
    small.file_bytes = 4 << 20U;
    return small;
  }
  static std::string payload(std::uint64_t number) {
    return std::string(message_bytes, static_cast<char>('a' + number % 26)) +
           std::to_string(number);
  }
  void keep(RetransmissionBuffer& kept, std::uint64_t number, const std::string& run = "",
            std::uint64_t of = session) {
    kept.keep({.session = of,
               .number = number,
               .acknowledged_run = run,
               .payload = std::make_shared<const std::string>(payload(number))},
              now_);
  }
  // One each second, from the numbers [first, end), while a run is under way.
  void keep_run(RetransmissionBuffer& kept, std::uint64_t first, std::uint64_t end) {
    for (std::uint64_t number = first; number < end; ++number) {
      kept.want(now_);
      keep(kept, number);
      kept.tidy(now_);
      now_ += 1s;
    }
  }
  static std::vector<std::uint64_t> numbers(RetransmissionBuffer& kept,
                                            RetransmissionBuffer::Place from = 0) {
    std::vector<std::uint64_t> all;
    while (auto found = kept.at_or_behind(from)) {
      EXPECT_EQ(*found->payload, payload(found->number)) << found->number;
      all.push_back(found->number);
      from = found->place + 1;
    }
    return all;
  }
  static std::vector<std::uint64_t> range(std::uint64_t first, std::uint64_t end) {
    std::vector<std::uint64_t> all;
    for (; first < end; ++first) {
      all.push_back(first);
    }
    return all;
  }

  tests::TemporaryFolder folder_;
  RetransmissionBuffer::Instant now_{std::chrono::hours(1)};
};

TEST_F(RetransmissionBufferTest, KeepsTheMinutesOfARunPartlyInMemoryPartlyInAFile) {
  RetransmissionBuffer kept(limits());
  keep_run(kept, 0, 200);
  EXPECT_EQ(numbers(kept), range(0, 200));
  EXPECT_EQ(kept.not_kept(), 0U);
  EXPECT_EQ(kept.problem(), "");
}

TEST_F(RetransmissionBufferTest, DropsWhatIsOlderThanItsSpan) {
  KeptLimits minute = limits();
  minute.span = 60s;
  RetransmissionBuffer kept(minute);
  keep_run(kept, 0, 200);
  kept.tidy(now_);
  EXPECT_EQ(numbers(kept), range(140, 200));
  EXPECT_EQ(kept.not_kept(), 0U);
}

// A run of half an hour can be taken over at its end.
TEST_F(RetransmissionBufferTest, KeepsTheNewestRunFromItsBeginningHoweverOldThatIs) {
  KeptLimits minute = limits();
  minute.span = 60s;
  RetransmissionBuffer kept(minute);
  keep_run(kept, 0, 100);
  kept.want(now_);
  keep(kept, 100, "first");
  keep_run(kept, 101, 300);
  EXPECT_EQ(numbers(kept), range(100, 300));
  EXPECT_EQ(kept.problem(), "");

  keep(kept, 300, "second"); // what the first one sent is as old as anything else now
  keep_run(kept, 301, 500);
  EXPECT_EQ(numbers(kept), range(300, 500));

  now_ += 61s; // and that run is over
  kept.tidy(now_);
  EXPECT_THAT(numbers(kept), IsEmpty());
  EXPECT_EQ(kept.problem(), "");
  EXPECT_EQ(kept.not_kept(), 0U);
}

TEST_F(RetransmissionBufferTest, SaysThatTheBeginningOfARunIsGoneForWantOfRoom) {
  RetransmissionBuffer kept(with_little_room());
  keep(kept, 0, "long");
  keep_run(kept, 1, 200);
  EXPECT_GT(numbers(kept).front(), 140U);
  EXPECT_THAT(kept.problem(), HasSubstr("min of run 'long', not its beginning"));
  EXPECT_THAT(kept.problem(), HasSubstr("4 MiB"));
}

TEST_F(RetransmissionBufferTest, SaysThatTheBeginningIsGoneAsLongAsTheRunLasts) {
  RetransmissionBuffer kept(with_little_room());
  keep(kept, 0, "long");
  keep_run(kept, 1, 100);
  for (int second = 0; second < 60; ++second) { // nothing more comes, and room is enough
    kept.want(now_);
    kept.tidy(now_);
    now_ += 1s;
  }
  EXPECT_THAT(kept.problem(), HasSubstr("min of run 'long', not its beginning"));
  now_ += 61s; // the run is over
  kept.tidy(now_);
  EXPECT_EQ(kept.problem(), "");
}

TEST_F(RetransmissionBufferTest, SaysThatARunIsLongerThanRunsAreKept) {
  KeptLimits hour = limits();
  hour.span = 20s;
  hour.run_span = 120s;
  RetransmissionBuffer kept(hour);
  keep(kept, 0, "long");
  keep_run(kept, 1, 200);
  EXPECT_EQ(numbers(kept).size(), 121U);
  EXPECT_THAT(kept.problem(), HasSubstr("no more than 2 min of a run are kept"));
}

TEST_F(RetransmissionBufferTest, KeepsOnlyTheNewestInMemoryWhileNoRunNeedsThem) {
  KeptLimits nowhere = limits();
  nowhere.folder = "/nowhere/at/all"; // would be noticed
  RetransmissionBuffer kept(nowhere);
  for (std::uint64_t number = 0; number < 200; ++number) {
    keep(kept, number);
    kept.tidy(now_);
    now_ += 1s;
  }
  EXPECT_EQ(numbers(kept), range(190, 200)); // 1 MiB
  EXPECT_EQ(kept.not_kept(), 0U);
  EXPECT_EQ(kept.problem(), "");
}

TEST_F(RetransmissionBufferTest, KeepsFewerMinutesAndSaysSoWhenTheFileIsFull) {
  KeptLimits small = limits();
  small.file_bytes = 4 << 20U;
  RetransmissionBuffer kept(small);
  keep_run(kept, 0, 200);
  const auto held = numbers(kept);
  EXPECT_EQ(held, range(held.front(), 200));
  EXPECT_GT(held.size(), 35U);
  EXPECT_LT(held.size(), 52U); // 5 MiB
  EXPECT_EQ(kept.not_kept(), 200 - held.size());
  EXPECT_THAT(kept.problem(), HasSubstr("of 10.0 min for who catches up"));
  EXPECT_THAT(kept.problem(), HasSubstr("4 MiB"));
}

TEST_F(RetransmissionBufferTest, KeepsWhatMemoryHoldsWhereThereCanBeNoFile) {
  KeptLimits nowhere = limits();
  nowhere.folder = "/nowhere/at/all";
  RetransmissionBuffer kept(nowhere);
  keep_run(kept, 0, 200);
  EXPECT_EQ(numbers(kept), range(190, 200));
  EXPECT_THAT(kept.problem(), HasSubstr("/nowhere/at/all"));
  now_ += 601s; // no longer short, when it no longer needs room
  kept.tidy(now_);
  EXPECT_EQ(kept.problem(), "");
}

TEST_F(RetransmissionBufferTest, NeverHoldsMoreMemoryThanItMayWhileTheDiskIsBehind) {
  RetransmissionBuffer kept(limits());
  kept.want(now_);
  for (std::uint64_t number = 0; number < 200; ++number) {
    keep(kept, number); // nobody tidies
  }
  EXPECT_TRUE(kept.tidy_due());
  const auto held = numbers(kept);
  EXPECT_EQ(held, range(held.front(), 200));
  EXPECT_LT(held.size() * message_bytes, 8U << 20U);
  EXPECT_EQ(kept.not_kept(), 200 - held.size());
  EXPECT_THAT(kept.problem(), HasSubstr("too slow"));
}

TEST_F(RetransmissionBufferTest, BeginsBehindTheMessageThatSomebodyHas) {
  RetransmissionBuffer kept(limits());
  keep_run(kept, 0, 30);
  EXPECT_EQ(numbers(kept, kept.place_behind(session, 12, "r")), range(13, 30));
  EXPECT_THAT(numbers(kept, kept.place_behind(session, 29, "r")), IsEmpty());
  EXPECT_THAT(numbers(kept, kept.place_behind(session, 100, "r")), IsEmpty());
}

TEST_F(RetransmissionBufferTest, GivesTheSessionsBehindTheOneThatEnded) {
  RetransmissionBuffer kept(limits());
  keep_run(kept, 0, 5);
  for (std::uint64_t number = 0; number < 3; ++number) {
    keep(kept, number, "", session + 1);
  }
  EXPECT_EQ(numbers(kept, kept.place_behind(session, 3, "r")),
            (std::vector<std::uint64_t>{4, 0, 1, 2}));
  EXPECT_EQ(numbers(kept, kept.place_behind(session, 4, "r")),
            (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_EQ(numbers(kept, kept.place_behind(session + 1, 0, "r")),
            (std::vector<std::uint64_t>{1, 2}));
}

TEST_F(RetransmissionBufferTest, GivesAllNewerSessionsBehindOneThatIsNotKeptAnyMore) {
  KeptLimits minute = limits();
  minute.span = 60s;
  RetransmissionBuffer kept(minute);
  keep_run(kept, 0, 5);
  now_ += 50s;
  keep(kept, 0, "", session + 1);
  keep(kept, 1, "run-2", session + 1);
  now_ += 30s;
  kept.tidy(now_);
  EXPECT_EQ(numbers(kept, kept.place_behind(session, 3, "run-2")),
            (std::vector<std::uint64_t>{0, 1}));
}

TEST_F(RetransmissionBufferTest, BeginsAtTheAnswerToTheRunForWhoHasNothingOrAnUnknownSession) {
  RetransmissionBuffer kept(limits());
  keep_run(kept, 0, 5);
  keep(kept, 5, "run-1");
  keep(kept, 6);
  keep(kept, 7, "run-1"); // asked twice
  EXPECT_EQ(numbers(kept, kept.place_behind(0, 0, "run-1")), range(5, 8));
  EXPECT_EQ(numbers(kept, kept.place_behind(12345, 6, "run-1")), range(5, 8));
  EXPECT_EQ(numbers(kept, kept.place_behind(0, 0, "never")), range(0, 8));
}

TEST_F(RetransmissionBufferTest, FindsRecordsBetweenMarksWithoutNumber) {
  RetransmissionBuffer kept(limits());
  keep(kept, 0, "run-1");
  for (const std::uint64_t number : {1, 2, 0, 3, 0}) { // 0: answers, the end
    keep(kept, number);
  }
  EXPECT_EQ(numbers(kept, kept.place_behind(session, 0, "run-1")),
            (std::vector<std::uint64_t>{1, 2, 0, 3, 0}));
  EXPECT_EQ(numbers(kept, kept.place_behind(session, 2, "run-1")),
            (std::vector<std::uint64_t>{3, 0}));
  EXPECT_EQ(numbers(kept, kept.place_behind(session, 3, "run-1")), (std::vector<std::uint64_t>{0}));
}

} // namespace
} // namespace dyncal::inline stream
