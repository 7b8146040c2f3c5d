#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/acs/socket_acs.hpp"

namespace dyncal::drivers::acs {
namespace {

constexpr const char* valid =
    R"({"protocol":"dyncal-acs-stream","version":1,"device":"card","serial":"17","sample_rate_hz":{"numerator":51200,"denominator":3},)"
    R"("origin_ns":-5,"time_base":"utc","values":"int32","channels":[{"name":"reference","unit":"\\volt","scale":0.5,"minimum":-1,"maximum":1}]})";

std::string with(const std::string& old_text, const std::string& new_text) {
  std::string text = valid;
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

TEST(StreamDescription, SaysEverythingAboutTheStream) {
  const auto stream = parse_stream_description(valid);
  ASSERT_TRUE(stream) << stream.error().message;
  EXPECT_EQ(stream->source.device, "card");
  EXPECT_EQ(stream->source.serial, "17");
  EXPECT_EQ(stream->source.time_base, TimeBase::utc);
  EXPECT_DOUBLE_EQ(stream->source.nominal_rate_hz, 51200.0 / 3.0);
  EXPECT_EQ(stream->clock.stamp_ns(51200), 3'000'000'000 - 5);
  EXPECT_EQ(stream->source.channels[0].unit, "\\volt");
  EXPECT_EQ(stream->source.channels[0].resolution, 0.5);
  EXPECT_EQ(stream->scale[0], 0.5);
  EXPECT_FALSE(stream->float64);
}

TEST(StreamDescription, NamesTheMemberThatIsWrong) {
  const std::pair<std::string, const char*> cases[] = {
      {"hello", "not JSON"},
      {"[1]", "'protocol' is missing"},
      {with("dyncal-acs-stream", "other"), "'protocol' must be"},
      {with(R"("origin_ns":-5,)", ""), "'origin_ns' is missing"},
      {with("-5", "-5.5"), "'origin_ns' has the wrong type"},
      {with(R"("numerator":51200)", R"("numerator":0)"),
       "'sample_rate_hz.numerator' and denominator must be positive"},
      {with("int32", "int16"), "'values' must be"},
      {with(R"("utc")", R"("tai")"), "'time_base' must be"},
      {with(R"("scale":0.5,)", ""), "'channels[0].scale' is missing"},
      {with("0.5", "-0.5"), "'channels[0].scale' must be above 0"},
      {with(R"("name":"reference",)", ""), "'channels[0].name' is missing"},
      {with(R"("name":"reference")", R"("name":")" + std::string(129, 'r') + '"'),
       "'channels[0].name' is longer than 128 bytes"},
      {with(R"({"name":"reference","unit":"\\volt","scale":0.5,"minimum":-1,"maximum":1})", ""),
       "'channels' must list 1 to 64"},
  };
  for (const auto& [line, message] : cases) {
    const auto stream = parse_stream_description(line);
    ASSERT_FALSE(stream) << line;
    EXPECT_EQ(stream.error().code, ErrorCode::malformed);
    EXPECT_THAT(stream.error().message, testing::HasSubstr(message)) << line;
  }
}

} // namespace
} // namespace dyncal::drivers::acs
