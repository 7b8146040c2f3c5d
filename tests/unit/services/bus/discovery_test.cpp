// What each vendor tells of the others in its domain.
#include "services/bus/discovery.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

#include <fmt/core.h>

#include "services/bus/participant_name.hpp"
#include "services/bus/vendor.hpp"
#include "services/contract/topics.hpp"
#include "tests/unit/services/bus/bus_pair.hpp"

namespace dyncal::bus {
namespace {

class DiscoveryTest : public testing::TestWithParam<CarrierPair> {
protected:
  static Participant join(Carrier carrier, const std::string& name, bool watch) {
    ParticipantOptions options;
    options.vendor = *carrier;
    options.domain = tests::own_dds_domain();
    options.name = name;
    options.watch_discovery = watch;
    return Participant::create(options).value();
  }
  template <class Condition>
  static bool wait_for(const Condition& condition) {
    WakeUp nobody_rings;
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while (!condition() && std::chrono::steady_clock::now() < deadline) {
      nobody_rings.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(20));
    }
    return condition();
  }
  // Of the topic; nothing if there is none.
  static std::optional<DiscoveredEndpoint> endpoint(const Participant& watching,
                                                    const std::string& topic) {
    const Discovery discovery = watching.discovered();
    const auto found = std::ranges::find(discovery.endpoints, topic, &DiscoveredEndpoint::topic);
    return found == discovery.endpoints.end() ? std::nullopt : std::optional(*found);
  }
};

TEST_P(DiscoveryTest, TellsOfOthersWithPartitionAndQosUntilTheyAreGone) {
  auto watching = join(GetParam().reader, "watching", true);
  std::optional<Participant> other(join(GetParam().writer, "other", false));
  auto writer = std::make_unique<Writer<wire::SourceStatus>>(
      other->writer(topics::source_status, "acc-1").value());
  std::optional<Reader<wire::Command>> reader(
      other->reader(topics::command, "acc-2", nullptr).value());
  ASSERT_TRUE(wait_for([&] {
    return endpoint(watching, topics::source_status) && endpoint(watching, topics::command);
  }));
  const Discovery discovery = watching.discovered();
  ASSERT_EQ(discovery.participants.size(), 1U) << "it leaves itself out";
  std::array<char, 256> host{};
  ASSERT_EQ(gethostname(host.data(), host.size() - 1), 0);
  EXPECT_EQ(discovery.participants[0].name, fmt::format("other:{} on {}", getpid(), host.data()));
  EXPECT_EQ(name_of(discovery, discovery.participants[0].id), discovery.participants[0].name);
  EXPECT_EQ(name_of(discovery, "0110"), "participant 0110");
  EXPECT_EQ(discovery.participants[0].vendor,
            GetParam().writer == Vendor::fast_dds ? "Fast DDS" : "Cyclone DDS");
  ASSERT_EQ(discovery.endpoints.size(), 2U);
  const auto status = endpoint(watching, topics::source_status);
  EXPECT_EQ(status->kind, EndpointKind::writer);
  EXPECT_EQ(status->participant, discovery.participants[0].id);
  EXPECT_EQ(status->type, "dyncal::wire::SourceStatus");
  EXPECT_EQ(status->partitions, (std::vector<std::string>{"acc-1", ""})) << "the default one, too";
  EXPECT_TRUE(status->reliable);
  EXPECT_TRUE(status->transient_local);
  const auto command = endpoint(watching, topics::command);
  EXPECT_EQ(command->kind, EndpointKind::reader);
  EXPECT_EQ(command->partitions, std::vector<std::string>{"acc-2"});
  EXPECT_TRUE(command->reliable);
  EXPECT_FALSE(command->transient_local);

  reader.reset();
  EXPECT_TRUE(wait_for([&] { return !endpoint(watching, topics::command); }));
  writer.reset();
  other.reset();
  EXPECT_TRUE(wait_for([&] { return watching.discovered().participants.empty(); }));
  EXPECT_TRUE(watching.discovered().endpoints.empty());
}

std::vector<CarrierPair> vendor_pairs() {
  auto pairs = carrier_pairs();
  std::erase_if(pairs, [](const CarrierPair& pair) { return !pair.writer; });
  return pairs;
}
INSTANTIATE_TEST_SUITE_P(Pairs, DiscoveryTest, testing::ValuesIn(vendor_pairs()), pair_name);

} // namespace
} // namespace dyncal::bus
