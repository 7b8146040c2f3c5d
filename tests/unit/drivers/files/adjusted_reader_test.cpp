#include "drivers/files/adjusted_reader.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/drivers/files/file_playing.hpp"

namespace dyncal::drivers::files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(AdjustedReader, ScalesChannelsAndMovesStamps) {
  const TemporaryFile file(
      "adjusted.csv", "t_ns,a [\\volt],b\n37000000001,1,2\n37000000005,3,4\n37000000007,5,6\n");
  FileSettings settings = settings_for(file);
  settings.time_offset_ns = -37'000'000'000;
  settings.scale = {{"a", -2.0}};
  settings.units = {{"a", "\\metre\\second\\tothe{-2}"}};
  FileSource source(settings);
  const auto description = source.describe();
  ASSERT_TRUE(description) << description.error().message;
  EXPECT_EQ(description->channels[0].unit, "\\metre\\second\\tothe{-2}");
  EXPECT_EQ(description->channels[0].quantity, "");
  CollectingSink sink;
  ASSERT_TRUE(source.run(sink));
  EXPECT_THAT(sink.stamps_ns, ElementsAre(1, 5, 7));
  EXPECT_THAT(sink.channel(0), ElementsAre(-2.0, -6.0, -10.0));
  EXPECT_THAT(sink.channel(1), ElementsAre(2.0, 4.0, 6.0));
}

TEST(AdjustedReader, RefusesWhatWouldBeWrong) {
  const TemporaryFile file("unit.csv", "t_ns,a [\\volt],b\n1,1,2\n2,3,4\n");
  FileSettings settings = settings_for(file);
  settings.scale = {{"a", 2.0}};
  EXPECT_THAT(problem_of(settings),
              HasSubstr("channel 'a' is scaled, but by the file its unit is \\volt"));
  settings.scale = {{"b", 2.0}}; // has none in the file
  EXPECT_EQ(problem_of(settings), "");
  settings.scale = {{"c", 2.0}};
  EXPECT_THAT(problem_of(settings), HasSubstr("unit.csv: no channel 'c' to scale"));
  settings.scale = {};
  settings.time_offset_ns = std::numeric_limits<std::int64_t>::max();
  EXPECT_THAT(problem_of(settings), HasSubstr("has a time that nanoseconds since 1970"));
}

} // namespace
} // namespace dyncal::drivers::files
