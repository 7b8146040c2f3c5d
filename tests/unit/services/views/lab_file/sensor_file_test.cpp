#include "services/views/lab_file/sensor_file.hpp"

#include <array>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>

namespace dyncal::inline views {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path example = std::filesystem::path(EXAMPLE_DOCUMENTS) / "sensor.toml";

TEST(SensorFile, ReadsTheExample) {
  const auto file = read_sensor_file(example);
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->serial, "0xbccb0100");
  EXPECT_EQ(file->certificate_number, "2026-0042");
  EXPECT_EQ(file->received, "2026-02-20");
  EXPECT_FALSE(file->customer);
  EXPECT_TRUE(file->conditions.empty());
}

TEST(SensorFile, NamesEachKeyThatIsMissing) {
  std::ifstream stream(example);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  for (const std::string key : {"name", "manufacturer", "model", "serial", "number"}) {
    const std::size_t begin = text.find("\n" + key + " =") + 1;
    ASSERT_NE(begin, 0U) << key;
    std::string without = text;
    without.erase(begin, text.find('\n', begin) - begin + 1);
    const auto file = parse_sensor_file(without, "s.toml");
    ASSERT_FALSE(file) << key;
    EXPECT_THAT(file.error().message,
                HasSubstr(key == "number" ? "'certificate.number' is missing"
                                          : "'sensor." + key + "' is missing"));
  }
  const auto empty = parse_sensor_file("", "s.toml");
  ASSERT_FALSE(empty);
  EXPECT_THAT(empty.error().message, HasSubstr("s.toml:1: key 'sensor' is missing"));
}

} // namespace
} // namespace dyncal::inline views
