#include "services/checks/doctor/announcement_listener.hpp"

#include <gtest/gtest.h>

#include <string>

#include "services/bus/discovery.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using std::string_literals::operator""s;

const std::string head = "RTPS\x02\x03\x01\x10\x01\x10\xAB\xCD\x04\x05\x06\x07\x08\x09\x0A\x0B"s;

TEST(AnnouncementListener, ReadsTheSenderOfAPacket) {
  EXPECT_EQ(sender_of_packet(head + "\x15"), "0110abcd0405060708090a0b");
  EXPECT_EQ(bus::vendor_of(sender_of_packet(head)), "Cyclone DDS");
}

TEST(AnnouncementListener, LeavesOtherPacketsOut) {
  EXPECT_EQ(sender_of_packet("RTPX" + head.substr(4)), "");
  EXPECT_EQ(sender_of_packet(""), "");
  EXPECT_EQ(sender_of_packet(head.substr(0, 10)), "");
}

TEST(AnnouncementListener, ReadsTheNameOfAProgramOfDyncal) {
  EXPECT_EQ(program_of_packet(head + "\x62\0\x14\0dyncal-analysis\0\x01"s), "dyncal-analysis");
  EXPECT_EQ(program_of_packet(head + "\x62\0\x14\0a robot\0"s), "");
}

TEST(Discovery, KnowsVendorsByTheirNumber) {
  EXPECT_EQ(bus::vendor_of("010f0102"), "Fast DDS");
  EXPECT_EQ(bus::vendor_of("01ff0102"), "vendor 01ff");
}

} // namespace
} // namespace dyncal::inline checks::doctor
