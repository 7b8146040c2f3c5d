#include "services/stream/catch_up_server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline stream {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint64_t session = 9;
const std::string bench = "acc";

wire::SampleBlock block_of(std::uint64_t number) {
  wire::SampleBlock block;
  block.bench(bench);
  block.source("acs");
  block.session(session);
  block.block(number);
  block.first_sample(number * 1000);
  block.sample_count(1000);
  block.channel_count(2);
  for (int i = 0; i < 2000; ++i) {
    block.values().push_back(static_cast<double>(number) + i * 1e-6);
  }
  return block;
}

class CatchUpServerTest : public testing::Test {
protected:
  CatchUpServerTest() {
    EXPECT_TRUE(catch_up_.add({.bench = bench, .source = "acs", .kind = SourceKind::acs}, kept_));
  }

  void keep(std::uint64_t first, std::uint64_t end) {
    for (; first < end; ++first) {
      kept_->want(clock_.now());
      kept_->tidy(clock_.now());
      kept_->keep({.session = session,
                   .number = first,
                   .acknowledged_run = first == 0 ? "run-1" : "",
                   .payload = bus::encode(block_of(first))},
                  clock_.now());
    }
  }

  bus::Reader<wire::SampleBlock> answers_of(const std::string& asker) {
    return asking_.reader(bus::topics::catch_up_samples, asker, nullptr).value();
  }

  void ask(const std::string& request, std::uint64_t after, const std::string& asker = "analysis",
           std::uint64_t of = session) {
    wire::CatchUpRequest message;
    message.bench(bench);
    message.source("acs");
    message.asker(asker);
    message.request(request);
    message.run("run-1");
    message.session(of);
    message.after(after);
    ASSERT_EQ(requests_.write(message), bus::WriteOutcome::written);
  }

  // What comes within a time in which the source does its rounds.
  std::vector<wire::SampleBlock> read(bus::Reader<wire::SampleBlock>& reader,
                                      std::chrono::nanoseconds time = 1s) {
    std::vector<wire::SampleBlock> blocks;
    run(time, [&] { reader.take([&](const wire::SampleBlock& one) { blocks.push_back(one); }); });
    return blocks;
  }
  void run(
      std::chrono::nanoseconds time, const std::function<void()>& meanwhile = [] {}) {
    const auto end = clock_.now() + time;
    while (clock_.now() < end) {
      const auto due = catch_up_.step();
      meanwhile();
      clock_.wait(*catch_up_.wake_up(), std::min(due, end));
    }
    meanwhile();
  }

  static std::vector<std::uint64_t> numbers(const std::vector<wire::SampleBlock>& blocks) {
    std::vector<std::uint64_t> all;
    for (const auto& block : blocks) {
      if (block.sample_count() > 0) {
        EXPECT_EQ(block, block_of(block.block()));
        all.push_back(block.block());
      }
    }
    return all;
  }

  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant sending_ = network_.join("source");
  bus::Participant asking_ = network_.join("analysis");
  std::shared_ptr<RetransmissionBuffer> kept_ =
      std::make_shared<RetransmissionBuffer>(KeptLimits{});
  CatchUpServer catch_up_{sending_, clock_};
  bus::Writer<wire::CatchUpRequest> requests_ =
      asking_.writer(bus::topics::catch_up_request, bench).value();
};

TEST_F(CatchUpServerTest, GivesWhatIsKeptBehindAMessageAndThenSaysThatThatWasAll) {
  keep(0, 100);
  auto reader = answers_of("analysis");
  ask("first", 90);
  const auto blocks = read(reader);
  EXPECT_THAT(numbers(blocks), ElementsAre(91, 92, 93, 94, 95, 96, 97, 98, 99));
  ASSERT_EQ(blocks.size(), 10U);
  const wire::SampleBlock& end = blocks.back();
  EXPECT_EQ(end.sample_count(), 0U);
  EXPECT_EQ(end.acknowledged_run(), "first");
  EXPECT_EQ(end.session(), session);
  EXPECT_EQ(end.block(), 99U);
  EXPECT_FALSE(end.end_of_stream());
}

TEST_F(CatchUpServerTest, AnswersBelowTheBenchAndWhereAnAskerOfContract2Wants) {
  keep(0, 3);
  for (const std::string asker : {"acc/catch-up/1", "catch-up/1"}) {
    auto reader = answers_of(asker);
    ask("first", 0, asker);
    EXPECT_THAT(numbers(read(reader)), ElementsAre(1, 2)) << asker;
  }
}

TEST_F(CatchUpServerTest, GivesTheVeryBytesThatAreKept) {
  keep(0, 3);
  auto reader = answers_of("analysis");
  std::vector<const char*> sent;
  network_.lose([&](const bus::MessageInTransit& message) {
    if (message.topic == bus::topics::catch_up_samples.name) {
      sent.push_back(message.payload.data());
    }
    return false;
  });
  ask("analysis/1", 0);
  EXPECT_THAT(numbers(read(reader)), ElementsAre(1, 2));
  ASSERT_EQ(sent.size(), 3U); // and the end of the answer
  EXPECT_EQ(sent[0], kept_->at_or_behind(1)->payload->data());
  EXPECT_EQ(sent[1], kept_->at_or_behind(2)->payload->data());
}

// By a bad disk: it would be refused by its reader, who would count it as malformed.
TEST_F(CatchUpServerTest, LeavesOutWhatWasDamagedWhileItWasKept) {
  keep(0, 2);
  std::string damaged = *bus::encode(block_of(2));
  damaged[200] = static_cast<char>(damaged[200] ^ 1);
  kept_->keep({.session = session,
               .number = 2,
               .acknowledged_run = "",
               .payload = std::make_shared<const std::string>(std::move(damaged))},
              clock_.now());
  keep(3, 4);
  auto reader = answers_of("analysis");
  ask("analysis/1", 0);
  EXPECT_THAT(numbers(read(reader)), ElementsAre(1, 3));
  EXPECT_EQ(asking_.malformed_messages(), 0U);
}

TEST_F(CatchUpServerTest, GivesAnEmptyAnswerToWhoHasEverything) {
  keep(0, 10);
  auto reader = answers_of("analysis");
  ask("first", 9);
  const auto blocks = read(reader);
  ASSERT_EQ(blocks.size(), 1U);
  EXPECT_EQ(blocks[0].acknowledged_run(), "first");
  EXPECT_EQ(blocks[0].block(), 9U);
}

TEST_F(CatchUpServerTest, GivesARunFromItsAnswerOnToWhoHasNothing) {
  keep(0, 700); // more than a writer holds
  auto reader = answers_of("analysis");
  ask("all", 0, "analysis", 0);
  const auto blocks = read(reader, 5s);
  ASSERT_EQ(numbers(blocks).size(), 700U);
  EXPECT_EQ(blocks.back().block(), 699U);
}

TEST_F(CatchUpServerTest, AnswersARepeatedRequestOnce) {
  keep(0, 10);
  auto reader = answers_of("analysis");
  ask("first", 5);
  ask("first", 5);
  EXPECT_EQ(read(reader).size(), 5U);
  ask("first", 5);
  EXPECT_THAT(read(reader), IsEmpty());
  ask("second", 7);
  EXPECT_THAT(numbers(read(reader)), ElementsAre(8, 9));
}

TEST_F(CatchUpServerTest, WaitsForTheReaderOfTheAsker) {
  keep(0, 10);
  ask("first", 7);
  run(2s);
  auto reader = answers_of("analysis");
  EXPECT_THAT(numbers(read(reader)), ElementsAre(8, 9));
}

TEST_F(CatchUpServerTest, AnswersARequestAgainWhoseReaderDidNotCome) {
  keep(0, 10);
  ask("first", 7);
  run(11s);
  auto reader = answers_of("analysis");
  EXPECT_THAT(read(reader), IsEmpty());
  ask("first", 7);
  EXPECT_THAT(numbers(read(reader)), ElementsAre(8, 9));
}

TEST_F(CatchUpServerTest, EndsAnAnswerWhoseReaderGoes) {
  keep(0, 700);
  {
    auto reader = answers_of("analysis");
    ask("first", 0);
    run(20ms);
  }
  run(4s);
  auto reader = answers_of("analysis");
  EXPECT_THAT(read(reader), IsEmpty());
}

TEST_F(CatchUpServerTest, ANewRequestOfTheSameAskerTakesThePlaceOfTheOneBefore) {
  keep(0, 2000);
  auto reader = answers_of("analysis");
  network_.stop_reading("analysis");
  ask("first", 0);
  run(1s);
  network_.resume_reading("analysis");
  ask("second", 1990);
  const auto blocks = read(reader, 5s);
  ASSERT_FALSE(blocks.empty());
  EXPECT_EQ(blocks.back().acknowledged_run(), "second");
  EXPECT_EQ(blocks.back().block(), 1999U);
  for (const auto& block : blocks) {
    EXPECT_NE(block.acknowledged_run(), "first");
  }
}

TEST_F(CatchUpServerTest, OneAskerThatHangsDoesNotHoldUpAnother) {
  keep(0, 1000);
  bus::Participant hanging = network_.join("hanging");
  auto idle = hanging.reader(bus::topics::catch_up_samples, "hanging", nullptr).value();
  network_.stop_reading("hanging");
  auto reader = answers_of("analysis");
  ask("h", 0, "hanging");
  run(1s);
  ask("a", 0, "analysis");
  EXPECT_EQ(numbers(read(reader, 3s)).size(), 999U);
  run(30s);
  network_.resume_reading("hanging");
  run(1s);
  std::size_t got = 0;
  idle.take([&](const wire::SampleBlock&) { ++got; });
  EXPECT_LT(got, 300U) << "it was broken off, with what had been on the wire";
}

TEST_F(CatchUpServerTest, GivesAlsoWhatWasWrittenMeanwhile) {
  keep(0, 500);
  auto reader = answers_of("analysis");
  ask("first", 0);
  run(20ms);
  keep(500, 520);
  const auto blocks = read(reader, 3s);
  EXPECT_EQ(numbers(blocks).size(), 519U);
  EXPECT_EQ(blocks.back().block(), 519U);
}

TEST_F(CatchUpServerTest, AnswersNoMoreAtOnceThanItMay) {
  keep(0, 10);
  std::vector<bus::Reader<wire::SampleBlock>> readers;
  for (std::size_t i = 0; i < CatchUpServer::max_answers + 5; ++i) {
    ask("first", 5, "asker-" + std::to_string(i)); // none of them has a reader yet
  }
  run(1s);
  auto early = answers_of("asker-0");
  auto late = answers_of("asker-" + std::to_string(CatchUpServer::max_answers));
  EXPECT_EQ(read(early).size(), 5U);
  EXPECT_THAT(read(late), IsEmpty());
  run(11s); // the others' readers do not come
  ask("first", 5, "asker-" + std::to_string(CatchUpServer::max_answers));
  EXPECT_EQ(read(late).size(), 5U);
}

TEST_F(CatchUpServerTest, LeavesRequestsForOthersAndNonsenseAlone) {
  keep(0, 10);
  auto reader = answers_of("analysis");
  wire::CatchUpRequest other;
  other.bench("elsewhere");
  other.source("acs");
  other.asker("analysis");
  other.request("x");
  requests_.write(other);
  other.bench(bench);
  other.source("dau");
  requests_.write(other);
  other.source("acs");
  other.request("");
  requests_.write(other);
  other.request(std::string(1000, 'x'));
  requests_.write(other);
  other.request("x");
  other.asker("*"); // would be a partition of everybody
  requests_.write(other);
  EXPECT_THAT(read(reader), IsEmpty());
}

TEST_F(CatchUpServerTest, GivesRecordsOfATriggeredSource) {
  auto kept = std::make_shared<RetransmissionBuffer>(KeptLimits{});
  ASSERT_TRUE(catch_up_.add({.bench = bench, .source = "dso", .kind = SourceKind::dso}, kept));
  wire::TriggeredRecord record;
  record.bench(bench);
  record.source("dso");
  record.session(session);
  record.values().assign(100, 0.25);
  for (std::uint64_t shot = 1; shot <= 3; ++shot) {
    record.shot(shot);
    kept->keep({.session = session,
                .number = shot,
                .acknowledged_run = "",
                .payload = bus::encode(record)},
               clock_.now());
  }
  auto reader = asking_.reader(bus::topics::catch_up_records, "analysis", nullptr).value();
  wire::CatchUpRequest message;
  message.bench(bench);
  message.source("dso");
  message.asker("analysis");
  message.request("first");
  message.session(session);
  message.after(1);
  ASSERT_EQ(requests_.write(message), bus::WriteOutcome::written);
  std::vector<std::uint64_t> shots;
  run(1s, [&] {
    reader.take([&](const wire::TriggeredRecord& one) {
      shots.push_back(one.shot());
      EXPECT_TRUE(one.acknowledged_run() == "first" || one.values().size() == 100);
    });
  });
  EXPECT_THAT(shots, ElementsAre(2, 3, 3));
}

} // namespace
} // namespace dyncal::inline stream
