// A meter and the programs that echo its probes over the memory bus, which loses what it is told
// to.
#include "services/bus/host_clocks/link_meter.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "services/bus/host_clocks/clock_responder.hpp"
#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline host_clocks {
namespace {

using namespace std::chrono_literals;
namespace topics = bus::topics;

class LinkMeterTest : public testing::Test {
protected:
  static ProgramIdentity identity(const std::string& program, std::uint32_t process_id = 4711) {
    return {program, "there", process_id, "dyncal 9.9.9", "cyclonedds"};
  }
  std::unique_ptr<ClockResponder> responder(std::uint32_t process_id = 4711) {
    return std::move(*ClockResponder::open(there_, identity("dyncal-acs", process_id), time_));
  }
  // A doctor: what asks for clocks and sends probes.
  struct Doctor {
    ClockAsker asker;
    LinkMeter meter;
  };
  Doctor doctor() {
    const ProgramIdentity own{"dyncal-doctor", "here", 1, "dyncal 9.9.9", "cyclonedds"};
    return {std::move(*ClockAsker::open(here_, own, time_, bell_, {.quick_requests = 1'000'000})),
            std::move(*LinkMeter::open(here_, own, time_, bell_))};
  }
  void pass(std::chrono::milliseconds time, Doctor& doctor,
            const std::vector<ClockResponder*>& responders) {
    for (auto passed = 0ms; passed < time; passed += 1ms) {
      time_.advance(1ms);
      for (ClockResponder* responder : responders) {
        responder->work();
      }
      doctor.asker.work();
      doctor.meter.work(doctor.asker.program_count());
    }
  }
  static LinkLoss loss(const Doctor& doctor) {
    const auto losses = doctor.meter.losses(doctor.asker.programs());
    EXPECT_EQ(losses.size(), 1U);
    return losses.empty() ? LinkLoss() : losses[0];
  }
  // Of probes or of their echoes those whose probe's number meets the condition.
  void lose(const std::string& topic, std::function<bool(std::uint64_t)> condition) {
    network_.lose([topic, condition](const bus::MessageInTransit& message) {
      return message.topic == topic &&
             condition(topic == topics::link_probe ? message.as<wire::LinkProbe>().number()
                                                   : message.as<wire::LinkEcho>().probe());
    });
  }
  void lose_long_probes() {
    network_.lose([](const bus::MessageInTransit& message) {
      return message.topic == topics::link_probe &&
             !message.as<wire::LinkProbe>().padding().empty();
    });
  }

  bus::SteppedClock time_;
  bus::MemoryNetwork network_{time_};
  bus::Participant here_ = network_.join("here");
  bus::Participant there_ = network_.join("there");
  std::shared_ptr<bus::WakeUp> bell_ = std::make_shared<bus::WakeUp>();
};

TEST_F(LinkMeterTest, FindsNoLossWhereNothingIsLost) {
  auto asking = doctor();
  const auto answering = responder();
  pass(3s, asking, {answering.get()});
  const LinkLoss found = loss(asking);
  EXPECT_TRUE(found.answers_probes);
  EXPECT_EQ(found.identity.program, "dyncal-acs");
  EXPECT_GT(found.sent, 200U);
  EXPECT_EQ(found.echoed, found.sent);
}

TEST_F(LinkMeterTest, CountsExactlyWhatIsLostInEitherDirection) {
  for (const std::string& topic :
       {std::string(topics::link_probe), std::string(topics::link_echo)}) {
    lose(topic, [](std::uint64_t number) { return number % 10 == 3; });
    auto asking = doctor();
    const auto answering = responder();
    pass(3s, asking, {answering.get()});
    const LinkLoss found = loss(asking);
    EXPECT_GT(found.sent, 200U) << topic;
    EXPECT_EQ(found.sent - found.echoed, (found.sent + 7) / 10) << topic;
  }
}

TEST_F(LinkMeterTest, SeesThatNoEchoComes) {
  for (const std::string& topic :
       {std::string(topics::link_probe), std::string(topics::link_echo)}) {
    lose(topic, [](std::uint64_t) { return true; });
    auto asking = doctor();
    const auto answering = responder();
    pass(3s, asking, {answering.get()});
    EXPECT_EQ(lost_part(loss(asking)), 1.0) << topic;
    EXPECT_GT(loss(asking).sent, 140U) << topic;
  }
}

TEST_F(LinkMeterTest, SeesThatNothingArrivesAnyLonger) {
  lose(topics::link_probe, [](std::uint64_t number) { return number > 100; });
  auto asking = doctor();
  const auto answering = responder();
  pass(3s, asking, {answering.get()});
  EXPECT_EQ(loss(asking).echoed, 100U);
  EXPECT_GT(loss(asking).sent, 140U);
}

TEST_F(LinkMeterTest, SeesThatLongPacketsAloneDoNotArrive) {
  lose_long_probes();
  auto asking = doctor();
  const auto answering = responder();
  pass(4s, asking, {answering.get()});
  const LinkLoss found = loss(asking);
  EXPECT_EQ(found.echoed, found.sent) << "short ones get through";
  EXPECT_GE(found.long_sent, fewest_probes);
  EXPECT_TRUE(drops_long_packets(found));
}

// The opposite: a way that loses one of four, of whatever length.
TEST_F(LinkMeterTest, BlamesNoLengthForWhatIsLostByChance) {
  lose(topics::link_echo, [](std::uint64_t number) { return number % 4 == 1; });
  auto asking = doctor();
  const auto answering = responder();
  pass(4s, asking, {answering.get()});
  EXPECT_GE(loss(asking).long_sent, fewest_probes);
  EXPECT_FALSE(drops_long_packets(loss(asking)));
  EXPECT_FALSE(drops_long_packets({.sent = 200, .echoed = 20, .long_sent = 50}));
}

TEST_F(LinkMeterTest, StatesNoPartOfAFew) {
  EXPECT_FALSE(lost_part({.sent = fewest_probes - 1}));
  EXPECT_EQ(lost_part({.sent = 200, .echoed = 150}), 0.25);
  EXPECT_FALSE(drops_long_packets({.sent = 200, .echoed = 200, .long_sent = fewest_probes - 1}));
}

TEST_F(LinkMeterTest, TakesNothingForLostThatWasSentBeforeAProgramWasThere) {
  auto asking = doctor();
  const auto first = responder(1);
  pass(2s, asking, {first.get()});
  const auto second = responder(2);
  pass(2s, asking, {first.get(), second.get()});
  const auto losses = asking.meter.losses(asking.asker.programs());
  ASSERT_EQ(losses.size(), 2U);
  EXPECT_GT(losses[0].sent, 240U);
  EXPECT_GT(losses[1].sent, 100U);
  EXPECT_LT(losses[1].sent, 210U);
  for (const LinkLoss& one : losses) {
    EXPECT_EQ(lost_part(one), 0.0);
  }
}

TEST_F(LinkMeterTest, BeginsANewSeriesWhereOneOfItsNameWasBefore) {
  const auto answering = responder();
  {
    auto before = doctor();
    pass(3s, before, {answering.get()});
  }
  lose(topics::link_probe, [](std::uint64_t number) { return number % 2 == 0; });
  auto asking = doctor();
  pass(3s, asking, {answering.get()});
  EXPECT_GT(loss(asking).sent, 200U);
  EXPECT_NEAR(lost_part(loss(asking)).value_or(0.0), 0.5, 0.01);
}

TEST_F(LinkMeterTest, DoesNotTakeAProgramThatAnswersNoProbesForALoss) {
  auto asking = doctor();
  auto answers = *there_.writer(topics::clock_answer, all_benches_partition);
  pass(10ms, asking, {});
  wire::ClockAnswer answer; // of an older version
  answer.bench(all_benches_partition);
  answer.asker("dyncal-doctor:1@here");
  answer.service("dyncal-acs:4711@there");
  answer.number(1);
  EXPECT_EQ(answers.write(answer), bus::WriteOutcome::written);
  pass(3s, asking, {});
  EXPECT_GT(asking.meter.probes(), 200U);
  EXPECT_FALSE(loss(asking).answers_probes);
  EXPECT_FALSE(lost_part(loss(asking)));
}

TEST_F(LinkMeterTest, CountsNoProbesAsLostThatWereSentAfterAProgramEnded) {
  auto asking = doctor();
  auto answering = responder();
  pass(2s, asking, {answering.get()});
  answering.reset();
  pass(5s, asking, {});
  EXPECT_GT(asking.meter.probes(), 400U);
  EXPECT_GT(loss(asking).sent, 100U);
  EXPECT_EQ(loss(asking).echoed, loss(asking).sent);
}

TEST_F(LinkMeterTest, SendsNothingBeforeAProgramAnswersAndEndsInTime) {
  auto asking = doctor();
  pass(2s, asking, {});
  EXPECT_EQ(asking.meter.probes(), 0U);
  const auto answering = responder();
  pass(30s, asking, {answering.get()});
  EXPECT_EQ(asking.meter.probes(), LinkMeter::max_probes);
  EXPECT_EQ(asking.meter.next_probe(), LinkMeter::Instant::max());
}

TEST_F(LinkMeterTest, SendsMoreSlowlyToManyPrograms) {
  auto asking = doctor();
  std::vector<std::unique_ptr<ClockResponder>> answering;
  std::vector<ClockResponder*> responders;
  for (std::uint32_t i = 0; i < 20; ++i) {
    responders.push_back(answering.emplace_back(responder(100 + i)).get());
  }
  pass(4s, asking, responders);
  EXPECT_GT(asking.meter.probes(), 80U);
  EXPECT_LT(asking.meter.probes(), 100U) << "one every 40 ms";
  EXPECT_EQ(asking.meter.losses(asking.asker.programs()).size(), 20U);
}

} // namespace
} // namespace dyncal::inline host_clocks
