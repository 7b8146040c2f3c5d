#include "services/bus/refused_packets.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(RefusedPackets, AreCountedAndSaidOnce) {
  std::vector<std::string> said;
  RefusedPackets refused([&](const std::string& sentence) { said.push_back(sentence); });
  EXPECT_EQ(refused.count(), 0U);
  EXPECT_EQ(refused.last_sender(), "");
  refused.add(192U << 24U | 2U << 8U | 7U);
  refused.add(0);
  EXPECT_EQ(refused.count(), 2U);
  EXPECT_EQ(refused.last_sender(), "") << "of the last one it is not known";
  refused.add(10U << 24U | 255U);
  EXPECT_EQ(refused.last_sender(), "10.0.0.255");
  EXPECT_THAT(
      said, ElementsAre(HasSubstr("refused a packet from 192.0.2.7 that is malformed, and will")));
}

// After a link was down some packets do not go on from those before.
TEST(RefusedPackets, AreImplausibleInLargeNumbersOnly) {
  std::vector<std::string> said;
  RefusedPackets refused([&](const std::string& sentence) { said.push_back(sentence); });
  for (std::uint64_t i = 0; i < RefusedPackets::many_implausible; ++i) {
    refused.add_implausible(10U << 24U | 255U);
  }
  EXPECT_EQ(refused.count(), 0U);
  EXPECT_THAT(said, testing::IsEmpty());
  refused.add_implausible(10U << 24U | 255U);
  EXPECT_EQ(refused.count(), 1U);
  EXPECT_THAT(said, ElementsAre(HasSubstr("a packet from 10.0.0.255 that is implausible")));
}

} // namespace
} // namespace dyncal::bus
