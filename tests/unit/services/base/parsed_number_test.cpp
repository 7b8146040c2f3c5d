#include "services/base/parsed_number.hpp"

#include <cstdint>

#include <gtest/gtest.h>

namespace dyncal::inline base {
namespace {

TEST(ParsedNumber, IsAllOfTheTextOrNothing) {
  EXPECT_EQ(parsed_number<double>("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(parsed_number<std::uint32_t>("bccb0100", 16), 0xbccb0100U);
  for (const char* text : {"", " 1", "1 ", "+1", "1s", "4294967296"}) {
    EXPECT_FALSE(parsed_number<std::uint32_t>(text)) << text;
  }
}

} // namespace
} // namespace dyncal::inline base
