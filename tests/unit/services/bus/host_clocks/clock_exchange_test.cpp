// Asker and responders over the memory bus, each with a clock of its own.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/host_clocks/clock_asker.hpp"
#include "services/bus/host_clocks/clock_responder.hpp"
#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline host_clocks {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::Field;

// The clock of another host: its own UTC and its own start, in step with the network's.
class HostClockOf final : public bus::Clock {
public:
  HostClockOf(bus::SteppedClock& network, std::chrono::nanoseconds ahead)
      : network_(network), ahead_(ahead) {}
  [[nodiscard]] Instant now() override { return network_.now() + 17h; }
  [[nodiscard]] std::int64_t utc_now_ns() override {
    return network_.utc_now_ns() + ahead_.count();
  }
  bool wait(bus::WakeUp& wake_up, Instant deadline) override {
    return network_.wait(wake_up, deadline - 17h);
  }
  void set(std::chrono::nanoseconds ahead) { ahead_ = ahead; }

private:
  bus::SteppedClock& network_;
  std::chrono::nanoseconds ahead_;
};

class ClockExchangeTest : public testing::Test {
protected:
  static ProgramIdentity identity(const std::string& program, const std::string& host) {
    return {program, host, 4711, "dyncal 9.9.9", "cyclonedds"};
  }
  ClockAsker asker(AskingPace pace = {}) {
    return std::move(
        *ClockAsker::open(here_, identity("dyncal-doctor", "here"), own_, bell_, pace));
  }
  std::unique_ptr<ClockResponder> responder(const std::string& program = "dyncal-acs") {
    return std::move(*ClockResponder::open(there_, identity(program, "there"), other_));
  }
  // Lets time pass in steps of a millisecond, as two threads that wait would.
  void pass(std::chrono::milliseconds time, ClockAsker& asker,
            const std::vector<ClockResponder*>& responders) {
    for (auto passed = 0ms; passed < time; passed += 1ms) {
      network_time_.advance(1ms);
      for (ClockResponder* responder : responders) {
        responder->work();
      }
      asker.work();
    }
  }

  bus::SteppedClock network_time_;
  bus::MemoryNetwork network_{network_time_};
  HostClockOf own_{network_time_, -5min};
  HostClockOf other_{network_time_, 1h};
  bus::Participant here_ = network_.join("here");
  bus::Participant there_ = network_.join("there");
  std::shared_ptr<bus::WakeUp> bell_ = std::make_shared<bus::WakeUp>();
};

TEST_F(ClockExchangeTest, FindsTheOffsetWithinHalfTheRoundTrip) {
  network_.delay([](const bus::MessageInTransit& message) {
    return message.receiver == "there" ? 30ms : 4ms; // the two directions differ
  });
  auto asking = asker();
  const auto answering = responder();
  pass(200ms, asking, {answering.get()});
  const auto hosts = asking.other_hosts();
  ASSERT_THAT(hosts, ElementsAre(Field(&HostClock::host, "there")));
  EXPECT_NEAR(hosts[0].clock.offset_s, 3900.0, hosts[0].clock.bound_s);
  EXPECT_NEAR(hosts[0].clock.bound_s, 0.017, 0.001);
  EXPECT_GT(std::abs(hosts[0].clock.offset_s - 3900.0), 0.010) << "the delays do differ";
}

TEST_F(ClockExchangeTest, TellsHowManyPacketsAProgramHasRefusedAndHowManyMeanwhile) {
  auto asking = asker({.quick_requests = 3, .quick_interval = 100ms});
  auto answers = *there_.writer(bus::topics::clock_answer, all_benches_partition);
  const auto answer = [&](std::uint64_t number, std::uint64_t refused) {
    asking.work();
    wire::ClockAnswer message;
    message.bench(all_benches_partition);
    message.asker(service_name(identity("dyncal-doctor", "here")));
    message.service("dyncal-acs:4711@there");
    message.number(number);
    message.packets_refused(refused);
    message.packets_refused_from("192.0.2.7");
    EXPECT_EQ(answers.write(message), bus::WriteOutcome::written);
    pass(100ms, asking, {});
  };
  answer(1, 40);
  answer(2, 42);
  answer(3, 49);
  const auto programs = asking.programs();
  ASSERT_EQ(programs.size(), 1U);
  EXPECT_EQ(programs[0].packets_refused, 49U);
  EXPECT_EQ(programs[0].packets_refused_now, 9U);
  EXPECT_EQ(programs[0].packets_refused_from, "192.0.2.7");
}

TEST_F(ClockExchangeTest, TellsWhoAnswers) {
  auto asking = asker();
  const auto answering = responder();
  pass(100ms, asking, {answering.get()});
  const auto programs = asking.programs();
  ASSERT_EQ(programs.size(), 1U);
  EXPECT_EQ(programs[0].identity.program, "dyncal-acs");
  EXPECT_EQ(programs[0].identity.host, "there");
  EXPECT_EQ(programs[0].identity.process_id, 4711U);
  EXPECT_EQ(programs[0].identity.software, "dyncal 9.9.9");
  EXPECT_EQ(programs[0].identity.dds, "cyclonedds");
  EXPECT_EQ(programs[0].contract_version, wire::CONTRACT_VERSION);
}

TEST_F(ClockExchangeTest, FollowsAClockThatIsSet) {
  auto asking = asker();
  const auto answering = responder();
  pass(3s, asking, {answering.get()});
  EXPECT_NEAR(asking.other_hosts().at(0).clock.offset_s, 3900.0, 0.01);
  other_.set(1h + 10s);
  pass(11s, asking, {answering.get()});
  EXPECT_NEAR(asking.other_hosts().at(0).clock.offset_s, 3910.0, 0.01);
}

TEST_F(ClockExchangeTest, LeavesOutAnExchangeDuringWhichItsOwnClockWasSet) {
  network_.delay([](const bus::MessageInTransit&) { return 20ms; });
  auto asking = asker({.quick_requests = 1});
  const auto answering = responder();
  pass(30ms, asking, {answering.get()});
  own_.set(-5min + 1s); // between request and answer
  pass(100ms, asking, {answering.get()});
  ASSERT_EQ(asking.programs().size(), 1U) << "it was heard";
  EXPECT_FALSE(asking.programs()[0].clock);
  pass(11s, asking, {answering.get()});
  EXPECT_NEAR(asking.other_hosts().at(0).clock.offset_s, 3899.0, 0.021);
}

TEST_F(ClockExchangeTest, GoesOnWhenMessagesAreLost) {
  network_.lose_randomly(0.5, 1);
  auto asking = asker();
  const auto answering = responder();
  pass(60s, asking, {answering.get()});
  EXPECT_NEAR(asking.other_hosts().at(0).clock.offset_s, 3900.0, 0.01);
}

TEST_F(ClockExchangeTest, AsksRarelyOnceItKnows) {
  auto asking = asker();
  const auto answering = responder();
  pass(60s, asking, {answering.get()});
  EXPECT_EQ(asking.requests(), 10U) << "5 in the first 2 s, then one every 10 s";
}

TEST_F(ClockExchangeTest, ForgetsAProgramThatHasEnded) {
  auto asking = asker();
  auto answering = responder();
  pass(3s, asking, {answering.get()});
  ASSERT_EQ(asking.programs().size(), 1U);
  answering.reset();
  pass(50s, asking, {});
  EXPECT_EQ(asking.programs().size(), 1U);
  pass(15s, asking, {});
  EXPECT_TRUE(asking.programs().empty());
}

TEST_F(ClockExchangeTest, HasOneClockForAHostWithManyPrograms) {
  auto asking = asker();
  const auto first = responder("dyncal-acs");
  const auto second = responder("dyncal-dau");
  pass(1s, asking, {first.get(), second.get()});
  EXPECT_EQ(asking.programs().size(), 2U);
  EXPECT_EQ(asking.other_hosts().size(), 1U);
}

TEST_F(ClockExchangeTest, HasNoOffsetToItsOwnHost) {
  auto asking = asker();
  auto same_host = std::move(*ClockResponder::open(there_, identity("dyncal-acs", "here"), own_));
  pass(1s, asking, {same_host.get()});
  EXPECT_EQ(asking.programs().size(), 1U);
  EXPECT_TRUE(asking.other_hosts().empty());
}

TEST_F(ClockExchangeTest, IsNotMisledByAnswersToOthersOrToNothing) {
  auto asking = asker();
  auto answers = there_.writer(bus::topics::clock_answer, all_benches_partition).value();
  wire::ClockAnswer answer;
  answer.bench(all_benches_partition);
  answer.service("dyncal-acs:1@there");
  answer.asker("dyncal-watch:1@elsewhere");
  answer.number(1);
  answers.write(answer);
  answer.asker(service_name(identity("dyncal-doctor", "here")));
  answer.number(1'000'000);
  answers.write(answer);
  pass(1s, asking, {});
  EXPECT_TRUE(asking.programs().empty());
}

TEST_F(ClockExchangeTest, AnswersNoMoreThanItsLimit) {
  const auto answering = responder();
  auto requests = here_.writer(bus::topics::clock_request, all_benches_partition).value();
  auto answers = here_.reader(bus::topics::clock_answer, all_benches_partition, bell_).value();
  wire::ClockRequest request;
  request.bench(all_benches_partition);
  request.asker("flood");
  for (std::uint64_t number = 1; number <= 200; ++number) {
    request.number(number);
    requests.write(request);
  }
  network_time_.advance(1ms);
  answering->work();
  network_time_.advance(1ms);
  EXPECT_EQ(answers.take([](const wire::ClockAnswer&) {}), ClockResponder::max_answers_per_s);
}

TEST_F(ClockExchangeTest, EchoesNoMoreThanItsLimit) {
  constexpr std::uint64_t limit = ClockResponder::max_echoes_per_s;
  const auto answering = responder();
  auto probes = here_.writer(bus::topics::link_probe, all_benches_partition).value();
  auto echoes = here_.reader(bus::topics::link_echo, all_benches_partition, bell_).value();
  wire::LinkProbe probe;
  probe.bench(all_benches_partition);
  probe.asker("flood");
  probe.series(7);
  std::size_t come = 0;
  wire::LinkEcho newest;
  const auto send = [&](std::uint64_t number) {
    probe.number(number);
    probes.write(probe);
    answering->work();
    come += echoes.take([&](const wire::LinkEcho& echo) { newest = echo; });
  };
  for (std::uint64_t number = 1; number <= limit + 300; ++number) {
    send(number);
  }
  EXPECT_EQ(come, limit);
  network_time_.advance(1s);
  send(limit + 301);
  EXPECT_EQ(come, limit + 1);
  EXPECT_EQ(newest.asker().to_string(), "flood");
  EXPECT_EQ(newest.service().to_string(), "dyncal-acs:4711@there");
  EXPECT_EQ(newest.series(), 7U);
  EXPECT_EQ(newest.probe(), limit + 301);
}

} // namespace
} // namespace dyncal::inline host_clocks
