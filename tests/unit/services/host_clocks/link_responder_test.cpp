#include "services/host_clocks/link_responder.hpp"

#include <gtest/gtest.h>

#include "services/bus/memory/memory_network.hpp"
#include "services/contract/topics.hpp"
#include "services/host_clocks/clock_messages.hpp"

namespace dyncal::services {
namespace {

using namespace std::chrono_literals;

class LinkResponderTest : public testing::Test {
protected:
  void send(const std::string& asker, std::uint64_t number, std::uint64_t series = 7) {
    wire::LinkProbe probe;
    probe.bench(all_benches_partition);
    probe.asker(asker);
    probe.series(series);
    probe.number(number);
    EXPECT_EQ(probes_.write(probe), bus::WriteOutcome::written);
    responder_.work();
  }
  std::vector<wire::LinkEcho> echoes() {
    std::vector<wire::LinkEcho> echoes;
    echoes_.take([&](const wire::LinkEcho& echo) { echoes.push_back(echo); });
    return echoes;
  }

  bus::SteppedClock clock_;
  bus::MemoryNetwork network_{clock_};
  bus::Participant here_ = network_.join("here");
  bus::Participant there_ = network_.join("there");
  std::shared_ptr<bus::WakeUp> bell_ = std::make_shared<bus::WakeUp>();
  bus::Writer<wire::LinkProbe> probes_ =
      here_.writer(bus::topics::link_probe, all_benches_partition).value();
  bus::Reader<wire::LinkEcho> echoes_ =
      here_.reader(bus::topics::link_echo, all_benches_partition, bell_).value();
  LinkResponder responder_ =
      LinkResponder::open(there_, "dyncal-acs:1@there", clock_, bell_).value();
};

TEST_F(LinkResponderTest, EchoesAProbeWithTheNumberOfTheEcho) {
  send("one", 4);
  send("two", 1);
  send("one", 6);
  const auto come = echoes();
  ASSERT_EQ(come.size(), 3U);
  EXPECT_EQ(come[2].asker().to_string(), "one");
  EXPECT_EQ(come[2].service().to_string(), "dyncal-acs:1@there");
  EXPECT_EQ(come[2].series(), 7U);
  EXPECT_EQ(come[2].probe(), 6U);
  EXPECT_EQ(come[2].number(), 2U);
  const ProbeCounts counts = responder_.counts("one");
  EXPECT_EQ(counts.first, 4U);
  EXPECT_EQ(counts.newest, 6U);
  EXPECT_EQ(counts.received, 2U);
  EXPECT_EQ(counts.echoed, 2U);
  EXPECT_EQ(responder_.counts("three").series, 0U);
}

TEST_F(LinkResponderTest, CountsAnewInANewSeries) {
  send("one", 200);
  send("one", 3, 8);
  EXPECT_EQ(responder_.counts("one").series, 8U);
  EXPECT_EQ(responder_.counts("one").first, 3U);
  EXPECT_EQ(responder_.counts("one").received, 1U);
}

TEST_F(LinkResponderTest, CountsNoProbeTwice) {
  send("one", 5);
  send("one", 5);
  send("one", 2);
  EXPECT_EQ(responder_.counts("one").received, 1U);
  EXPECT_EQ(echoes().size(), 1U);
}

TEST_F(LinkResponderTest, EchoesNoMoreThanItsLimitAndCountsWhatItDoesNot) {
  constexpr std::uint64_t limit = LinkResponder::max_echoes_per_s;
  std::size_t come = 0;
  for (std::uint64_t number = 1; number <= limit + 300; ++number) {
    send("flood", number);
    come += echoes().size();
  }
  EXPECT_EQ(come, limit);
  EXPECT_EQ(responder_.counts("flood").received, limit + 300);
  EXPECT_EQ(responder_.counts("flood").echoed, limit);
  EXPECT_EQ(responder_.not_echoed(), 300U);
  clock_.advance(1s);
  send("flood", limit + 301);
  EXPECT_EQ(echoes().size(), 1U);
}

TEST_F(LinkResponderTest, ForgetsWhoHasBeenSilentLongest) {
  for (std::size_t i = 0; i < LinkResponder::max_askers; ++i) {
    clock_.advance(1ms);
    send("asker " + std::to_string(i), 1);
  }
  clock_.advance(1ms);
  send("asker 0", 2);
  EXPECT_EQ(responder_.forgotten_askers(), 0U);
  clock_.advance(1ms);
  send("one more", 1);
  EXPECT_EQ(responder_.forgotten_askers(), 1U);
  EXPECT_EQ(responder_.counts("asker 1").received, 0U);
  EXPECT_EQ(responder_.counts("asker 0").received, 2U);
  EXPECT_EQ(responder_.counts("asker 2").received, 1U);
  EXPECT_EQ(responder_.counts("one more").received, 1U);
}

} // namespace
} // namespace dyncal::services
