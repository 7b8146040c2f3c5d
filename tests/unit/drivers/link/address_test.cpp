#include "drivers/link/address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::drivers {
namespace {

using ::testing::HasSubstr;

TEST(Address, IsReadFromHostAndPort) {
  const auto name = parse_address("lab-3:5026");
  ASSERT_TRUE(name) << name.error().message;
  EXPECT_EQ(name->host, "lab-3");
  EXPECT_EQ(name->port, 5026);
  EXPECT_EQ(name->text(), "lab-3:5026");

  const auto version_6 = parse_address("[::1]:80");
  ASSERT_TRUE(version_6) << version_6.error().message;
  EXPECT_EQ(version_6->host, "::1");
  EXPECT_EQ(version_6->port, 80);
}

TEST(Address, IsRefusedWithAnExampleWhenHostOrPortIsMissing) {
  for (const char* text : {"", "localhost", ":5026", "localhost:", "localhost:port",
                           "localhost:70000", "localhost:-1", "localhost:5x", "localhost:80 "}) {
    const auto address = parse_address(text);
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().code, ErrorCode::malformed);
    EXPECT_THAT(address.error().message, HasSubstr("write HOST:PORT, for example 127.0.0.1:5026"));
  }
}

} // namespace
} // namespace dyncal::drivers
