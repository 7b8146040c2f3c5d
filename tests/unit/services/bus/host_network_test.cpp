#include "services/bus/host_network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

using testing::HasSubstr;

TEST(HostNetwork, FindsTheLoopbackInterfaceByNameAndByAddress) {
  EXPECT_EQ(interface_address("lo").value_or("none"), "127.0.0.1");
  EXPECT_EQ(interface_address("127.0.0.1").value_or("none"), "127.0.0.1");
}

TEST(HostNetwork, NamesTheInterfacesThereAreWhenOneIsNot) {
  const auto address = interface_address("eth99");
  ASSERT_FALSE(address);
  EXPECT_EQ(address.error().code, base::ErrorCode::network);
  EXPECT_THAT(address.error().message, HasSubstr("\"eth99\""));
  EXPECT_THAT(address.error().message, HasSubstr("lo (127.0.0.1)"));
}

TEST(HostNetwork, TakesPeersAsAddressesAndNamesThoseWithoutOne) {
  const auto peers = resolve_peers({"10.9.0.1", "127.0.0.1"});
  ASSERT_TRUE(peers);
  EXPECT_EQ(*peers, (std::vector<std::string>{"10.9.0.1", "127.0.0.1"}));
  const auto missing = resolve_peers({"10.9.0.1", "no-such-host.invalid"});
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("\"no-such-host.invalid\""));
}

TEST(HostNetwork, WarnsOfASmallReceiveBufferInOneSentence) {
  EXPECT_EQ(receive_buffer_warning(4 << 20, 4 << 20), "");
  EXPECT_EQ(receive_buffer_warning(4 << 20, 0), ""); // not known
  const std::string warning = receive_buffer_warning(4 << 20, 212992);
  EXPECT_THAT(warning, HasSubstr("212992"));
  EXPECT_THAT(warning, HasSubstr("it works"));
  EXPECT_THAT(warning, HasSubstr("sysctl -w net.core.rmem_max="));
}

TEST(HostNetwork, AsksTheKernelWhatItGrants) {
  EXPECT_EQ(granted_receive_buffer(8192), 8192);
  EXPECT_LE(granted_receive_buffer(1 << 30), 1 << 30);
}

} // namespace
} // namespace dyncal::bus
