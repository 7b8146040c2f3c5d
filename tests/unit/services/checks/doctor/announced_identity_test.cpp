#include "services/checks/doctor/announced_identity.hpp"

#include <gtest/gtest.h>

namespace dyncal::inline checks::doctor {
namespace {

using std::string_literals::operator""s;

// As Fast DDS 2.9 was heard to announce them.
const std::string authority =
    "\x0a\0\0\0dds.ca.sn\0\0\0\x1b\0\0\0/O=Lab/OU=cd1e61cb/CN=auth"s + "\0\0"s;
const std::string protection = "\x05\x10\x08\0\x06\0\0\x80\x06\0\0\x80"s;

TEST(AnnouncedIdentity, IsReadFromAPacket) {
  const auto identity = identity_of_packet("RTPS..." + authority + protection);
  EXPECT_EQ(identity.authority, "/O=Lab/OU=cd1e61cb/CN=auth");
  EXPECT_EQ(identity.protection, 0x8000'0006'8000'0006U);
}

TEST(AnnouncedIdentity, IsNotThereInOthers) {
  for (const std::string& packet :
       {""s, "RTPS of a plain program"s, "\x05\x10\x08\0\x06\0\0\0\x06\0\0\x80"s}) {
    const auto identity = identity_of_packet(packet);
    EXPECT_EQ(identity.authority, "");
    EXPECT_FALSE(identity.protection);
  }
}

TEST(AnnouncedIdentity, IsNotReadBeyondThePacket) {
  const std::string whole = authority + protection;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(identity_of_packet(whole.substr(0, size)).protection);
  }
  std::string longer = authority;
  longer[16] = '\x7f'; // its length
  EXPECT_EQ(identity_of_packet(longer).authority, "");
  longer[19] = '\x7f';
  EXPECT_EQ(identity_of_packet(longer).authority, "");
}

} // namespace
} // namespace dyncal::inline checks::doctor
