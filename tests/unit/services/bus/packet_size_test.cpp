#include "services/bus/packet_size.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "services/bus/host_network.hpp"
#include "services/bus/qos_profiles.hpp"
#include "services/contract/topics.hpp"
#include "tests/unit/services/bus/bus_pair.hpp"

namespace dyncal::bus {
namespace {

int payload(LaboratoryVendors laboratory, const std::string& interface_name) {
  ParticipantOptions options;
  options.laboratory = laboratory;
  options.interface_name = interface_name;
  return packet_payload_bytes(options);
}

TEST(PacketSize, IsThatOfEthernetInAMixedLaboratory) {
  for (const char* interface_name : {"", "lo", "127.0.0.1", "no-such-interface"}) {
    EXPECT_EQ(payload(LaboratoryVendors::mixed, interface_name), 1472) << interface_name;
  }
}

TEST(PacketSize, IsThatOfTheInterfaceWhereAllHaveOneVendor) {
  ASSERT_GE(interface_mtu("lo"), 65535);
  EXPECT_EQ(payload(LaboratoryVendors::same, "lo"), 65500);
  EXPECT_EQ(payload(LaboratoryVendors::same, "127.0.0.1"), 65500);
  EXPECT_EQ(payload(LaboratoryVendors::same, "no-such-interface"), 1472);
  const auto addresses = host_addresses().value();
  for (const HostAddress& one : addresses) {
    const int mtu = interface_mtu(one.interface).value();
    EXPECT_LE(payload(LaboratoryVendors::same, one.interface), mtu - 28) << one.interface;
    EXPECT_GT(payload(LaboratoryVendors::same, one.interface), std::min(65536, mtu) - 40)
        << one.interface;
    if (!one.loopback) {
      EXPECT_LE(payload(LaboratoryVendors::same, ""), mtu - 28) << one.interface;
    }
  }
}

class LongPackets : public testing::TestWithParam<CarrierPair> {
protected:
  static Participant join(Vendor vendor) {
    ParticipantOptions options;
    options.vendor = vendor;
    options.laboratory = LaboratoryVendors::same;
    options.domain = tests::own_dds_domain();
    options.name = "long packets";
    options.interface_name = "lo";
    return Participant::create(options).value();
  }
};

std::vector<CarrierPair> vendor_pairs() {
  auto pairs = carrier_pairs();
  pairs.pop_back(); // the memory bus has no packets
  return pairs;
}

INSTANTIATE_TEST_SUITE_P(AllPairs, LongPackets, testing::ValuesIn(vendor_pairs()), pair_name);

// Of different vendors, too, where somebody has said wrongly that there is one.
TEST_P(LongPackets, CarryBlocksOfAnyLengthWholeAndInOrder) {
  constexpr std::uint64_t blocks = 400;
  std::mt19937_64 random(39);
  std::uniform_int_distribution<std::size_t> values(0, 25'000); // up to 200 kB
  Participant writing = join(*GetParam().writer);
  Participant reading = join(*GetParam().reader);
  const auto bell = std::make_shared<WakeUp>();
  auto reader = reading.reader(topics::dau_samples, "long-packets", bell).value();
  auto writer = writing.writer(topics::dau_samples, "long-packets").value();
  std::vector<std::size_t> lengths;
  std::uint64_t received = 0;
  const auto take = [&] {
    reader.take([&](const wire::SampleBlock& block) {
      ASSERT_EQ(block.block(), received);
      ASSERT_EQ(block.values().size(), lengths[received]);
      ASSERT_TRUE(std::ranges::all_of(
          block.values(), [&](double value) { return value == static_cast<double>(received); }));
      ++received;
    });
  };
  wire::SampleBlock block;
  block.bench("long-packets");
  block.source("dau");
  for (std::uint64_t number = 0; number < blocks; ++number) {
    lengths.push_back(values(random));
    block.block(number);
    block.values().assign(lengths.back(), static_cast<double>(number));
    ASSERT_EQ(writer.write(block), WriteOutcome::written);
    take();
  }
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (received < blocks && std::chrono::steady_clock::now() < deadline) {
    bell->wait_until(deadline);
    take();
  }
  EXPECT_EQ(received, blocks);
}

// More blocks than may be on their way: neither a reader that has yet to take them nor one that has
// gone holds the writer up, and none is missing.
TEST_P(LongPackets, ArePacedByAcknowledgmentsAlone) {
  constexpr std::uint64_t blocks = 400;
  Participant writing = join(*GetParam().writer);
  auto writer =
      writing.writer<wire::SampleBlock>("DauSamples", Profile::paced_samples, "paced").value();
  wire::SampleBlock block;
  block.bench("paced");
  block.source("dau");
  block.values().assign(5000, 1.0);
  const auto write = [&] {
    for (std::uint64_t number = 0; number < blocks; ++number) {
      block.block(number);
      ASSERT_EQ(writer.write(block, tests::patience), WriteOutcome::written) << number;
    }
  };
  {
    Participant reading = join(*GetParam().reader);
    WakeUp bell;
    auto reader =
        reading.reader<wire::SampleBlock>("DauSamples", Profile::live_samples, "paced", {}).value();
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while ((writer.matched_readers() == 0 || reader.matched_writers() == 0) &&
           std::chrono::steady_clock::now() < deadline) {
      bell.wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(5));
    }
    write();
    ASSERT_TRUE(writer.wait_for_acknowledgments(tests::patience));
    std::uint64_t received = 0;
    reader.take([&](const wire::SampleBlock& one) { EXPECT_EQ(one.block(), received++); });
    EXPECT_EQ(received, blocks);
  }
  write();
}

} // namespace
} // namespace dyncal::bus
