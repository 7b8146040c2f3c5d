#include "services/checks/doctor/announcement_listener.hpp"

#include <gtest/gtest.h>

#include "services/bus/discovery.hpp"

namespace dyncal::inline checks::doctor {
namespace {

TEST(AnnouncementListener, ReadsTheSenderOfAPacket) {
  const unsigned char packet[] = {'R',  'T', 'P', 'S', 2, 3, 1, 0x10, 1,  0x10, 0xAB,
                                  0xCD, 4,   5,   6,   7, 8, 9, 10,   11, 0x15, 0};
  EXPECT_EQ(sender_of_packet(packet, sizeof(packet)), "0110abcd0405060708090a0b");
  EXPECT_EQ(bus::vendor_of(sender_of_packet(packet, sizeof(packet))), "Cyclone DDS");
}

TEST(AnnouncementListener, LeavesOtherPacketsOut) {
  const unsigned char packet[] = {'R', 'T', 'P', 'X', 2, 3, 1, 0x10, 1, 0x10,
                                  0,   0,   0,   0,   0, 0, 0, 0,    0, 0};
  EXPECT_EQ(sender_of_packet(packet, sizeof(packet)), "");
  EXPECT_EQ(sender_of_packet(packet, 0), "");
  const unsigned char cut[] = {'R', 'T', 'P', 'S', 2, 3, 1, 0x10, 1, 0x10};
  EXPECT_EQ(sender_of_packet(cut, sizeof(cut)), "");
}

TEST(Discovery, KnowsVendorsByTheirNumber) {
  EXPECT_EQ(bus::vendor_of("010f0102"), "Fast DDS");
  EXPECT_EQ(bus::vendor_of("01ff0102"), "vendor 01ff");
}

} // namespace
} // namespace dyncal::inline checks::doctor
