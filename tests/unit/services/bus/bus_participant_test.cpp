#include <algorithm>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bus/bus.hpp"
#include "services/bus/vendor.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace dyncal::bus {
namespace {

using testing::HasSubstr;

class BusParticipant : public testing::TestWithParam<Vendor> {
protected:
  static ParticipantOptions options() {
    ParticipantOptions options;
    options.vendor = GetParam();
    options.domain = tests::own_dds_domain();
    options.name = "participant test";
    return options;
  }
};

INSTANTIATE_TEST_SUITE_P(AllVendors, BusParticipant, testing::ValuesIn(vendors_in_this_build()),
                         [](const auto& vendor) { return to_string(vendor.param); });

TEST_P(BusParticipant, RefusesADomainThatDoesNotExist) {
  for (const int domain : {-1, 233}) {
    ParticipantOptions wrong = options();
    wrong.domain = domain;
    const auto participant = Participant::create(wrong);
    ASSERT_FALSE(participant);
    EXPECT_EQ(participant.error().code, base::ErrorCode::network);
    EXPECT_THAT(participant.error().message, HasSubstr(std::to_string(domain)));
  }
}

TEST_P(BusParticipant, RefusesAnInterfaceOrAPeerThatDoesNotExist) {
  ParticipantOptions wrong = options();
  wrong.interface_name = "eth99";
  const auto without_interface = Participant::create(wrong);
  ASSERT_FALSE(without_interface);
  EXPECT_THAT(without_interface.error().message, HasSubstr("eth99"));
  wrong = options();
  wrong.peers = {"no-such-host.invalid"};
  const auto without_peer = Participant::create(wrong);
  ASSERT_FALSE(without_peer);
  EXPECT_THAT(without_peer.error().message, HasSubstr("no-such-host.invalid"));
}

TEST_P(BusParticipant, RefusesAWriterForABenchWhoseNameIsTooLongOrAPattern) {
  auto participant = Participant::create(options());
  ASSERT_TRUE(participant);
  for (const std::string& bench : {std::string(65, 'b'), std::string("*"), std::string()}) {
    const auto writer =
        participant->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples, bench);
    ASSERT_FALSE(writer) << bench;
    EXPECT_EQ(writer.error().code, base::ErrorCode::bad_argument);
  }
  EXPECT_TRUE(participant->writer<wire::SampleBlock>(topics::dau_samples, Profile::samples,
                                                     std::string(64, 'b')));
}

TEST_P(BusParticipant, JoinsByPeersAloneOnTheLoopbackInterface) {
  ParticipantOptions unicast = options();
  unicast.multicast = false;
  unicast.interface_name = "lo";
  auto one = Participant::create(unicast);
  ASSERT_TRUE(one) << one.error().message;
  auto two = Participant::create(unicast);
  ASSERT_TRUE(two) << two.error().message;
  const std::string bench = "participant-test";
  auto bell = std::make_shared<WakeUp>();
  auto writer = one->writer<wire::Command>(topics::command, Profile::state, bench);
  auto reader = two->reader<wire::Command>(topics::command, Profile::state, bench, bell);
  ASSERT_TRUE(writer && reader);
  wire::Command command;
  command.target("dau");
  ASSERT_EQ(writer->write(command), WriteOutcome::written);
  std::size_t taken = 0;
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  while (taken == 0 && bell->wait_until(deadline)) {
    taken = reader->take([](const wire::Command&) {});
  }
  EXPECT_EQ(taken, 1U);
}

TEST_P(BusParticipant, CanBeMadeAgainAfterItIsGone) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(Participant::create(options()));
  }
}

TEST(BusVendor, IsNamedAsInThisBuild) {
  for (const Vendor vendor : vendors_in_this_build()) {
    EXPECT_EQ(parse_vendor(to_string(vendor)), vendor);
  }
  const auto wrong = parse_vendor("opendds");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, base::ErrorCode::bad_argument);
  EXPECT_THAT(wrong.error().message, HasSubstr("'opendds'"));
  for (const Vendor vendor : vendors_in_this_build()) {
    EXPECT_THAT(wrong.error().message, HasSubstr(to_string(vendor)));
  }
}

// The default of every program: Fast DDS of Debian 12 ends at packets that Cyclone DDS survives.
TEST(BusVendor, IsCycloneDdsWhereNoneIsChosen) {
  const auto built = vendors_in_this_build();
  if (std::find(built.begin(), built.end(), Vendor::cyclone_dds) != built.end()) {
    EXPECT_EQ(built.front(), Vendor::cyclone_dds);
  }
}

TEST(BusVendor, IsNeverTheBusOfUnitTests) {
  const auto memory = parse_vendor("memory");
  ASSERT_FALSE(memory);
  EXPECT_EQ(memory.error().code, base::ErrorCode::bad_argument);
  EXPECT_THAT(memory.error().message, HasSubstr("cannot leave a process"));
}

TEST(BusVendor, OutsideThisBuildIsRefusedByName) {
  for (const Vendor vendor : {Vendor::fast_dds, Vendor::cyclone_dds}) {
    const auto built = vendors_in_this_build();
    if (std::find(built.begin(), built.end(), vendor) != built.end()) {
      continue;
    }
    ParticipantOptions options;
    options.vendor = vendor;
    const auto participant = Participant::create(options);
    ASSERT_FALSE(participant);
    EXPECT_THAT(participant.error().message, HasSubstr(to_string(vendor)));
  }
}

} // namespace
} // namespace dyncal::bus
