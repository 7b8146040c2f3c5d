#include "drivers/tss/series.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dyncal::drivers::tss {
namespace {

constexpr const char* header_text =
    R"({"protocol":"dyncal-series","version":1,"device":"d","serial":"s","shot":7,"nominal_rate_hz":1000.0,"samples":2,"values":"int16",)"
    R"("channels":[{"name":"x","unit":"\\metre\\second\\tothe{-2}","scale":0.5},{"name":"y","scale":0.25}]})";

TEST(Series, ValuesAreScaledAndSortedByChannel) {
  auto header = parse_series_header(header_text);
  ASSERT_TRUE(header.has_value()) << header.error().message;
  EXPECT_EQ(header->bytes(), 8U);
  const char bytes[] = {2, 0, 4, 0, -1, -1, 0, 1};
  const auto series = decode_series(*header, bytes);
  ASSERT_TRUE(series.has_value()) << series.error().message;
  EXPECT_EQ(series->shot, 7U);
  EXPECT_EQ(series->channels[0].unit, "\\metre\\second\\tothe{-2}");
  EXPECT_THAT(series->values, testing::ElementsAre(1.0, -0.5, 1.0, 64.0));
}

TEST(Series, AWrongNumberOfBytesIsRefused) {
  const auto header = parse_series_header(header_text);
  const char bytes[] = {2, 0, 4, 0, -1, -1};
  EXPECT_FALSE(decode_series(*header, bytes).has_value());
}

TEST(Series, AHeaderThatCannotBeIsRefused) {
  for (
      const char* text :
      {"", "{}", "[]", "null", "0,\"No error\"", R"({"protocol":"dyncal-series","version":2})",
       R"({"protocol":"dyncal-series","version":1.4e111})", R"({"protocol":5})",
       R"({"protocol":"dyncal-series","version":1,"shot":-1,"nominal_rate_hz":1000.0,"samples":2,"values":"int16","channels":[{"name":"x"}]})",
       R"({"protocol":"dyncal-series","version":1,"shot":1,"nominal_rate_hz":0,"samples":2,"values":"int16","channels":[{"name":"x"}]})",
       R"({"protocol":"dyncal-series","version":1,"shot":1,"nominal_rate_hz":1e3,"samples":1e18,"values":"int16","channels":[{"name":"x"}]})",
       R"({"protocol":"dyncal-series","version":1,"shot":1,"nominal_rate_hz":1e3,"samples":2,"values":"int12","channels":[{"name":"x"}]})",
       R"({"protocol":"dyncal-series","version":1,"shot":1,"nominal_rate_hz":1e3,"samples":2,"values":"int16","channels":[]})"}) {
    EXPECT_FALSE(parse_series_header(text).has_value()) << text;
  }
}

TEST(Series, ACsvFileSaysTheSame) {
  const auto series = parse_series_csv("# device = recorder 3\r\n# shot = 7\r\n# nominal_rate_hz = "
                                       "1e3\r\nx, y\r\n1,2\r\n-0.5,4\r\n");
  ASSERT_TRUE(series.has_value()) << series.error().message;
  EXPECT_EQ(series->device, "recorder 3");
  EXPECT_EQ(series->shot, 7U);
  EXPECT_EQ(series->samples, 2U);
  EXPECT_THAT(series->values, testing::ElementsAre(1.0, -0.5, 2.0, 4.0));
}

TEST(Series, ACsvErrorNamesItsLine) {
  const auto series = parse_series_csv("# nominal_rate_hz = 1000\nx,y\n1,2\n3\n");
  ASSERT_FALSE(series.has_value());
  EXPECT_THAT(series.error().message, testing::HasSubstr("line 4: 1 values for 2 channels"));
  EXPECT_FALSE(parse_series_csv("x\n1\n").has_value()); // no rate
  EXPECT_FALSE(parse_series_csv("# nominal_rate_hz = 1000\nx\n").has_value());
  EXPECT_FALSE(parse_series_csv("# nominal_rate_hz = 1000\n# shot = 1.5\nx\n1\n").has_value());
}

} // namespace
} // namespace dyncal::drivers::tss
