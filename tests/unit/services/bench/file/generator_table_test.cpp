#include <gmock/gmock.h>

#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline bench {
namespace {

using ::testing::HasSubstr;

Expected<BenchFile> bench_with(const std::string& generator, const std::string& excitation = "") {
  return parse_bench_file(R"(bench = "acc-1"
[excitation]
frequencies_hz = ["10"]
level = 2.0
settling_s = 0.5
duration_s = 2.0
)" + excitation + "[generator]\n" +
                              generator + R"(
[sources.dau]
driver = "smartup"
sensor = "0xbccb0100"
[sources.acs]
driver = "socket"
address = "127.0.0.1:2"
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
)",
                          "bench.toml");
}

TEST(GeneratorTable, HoldsToleranceAndLimits) {
  const auto bench =
      bench_with("driver = \"scpi\"\naddress = \"a:1\"\nlevel_per_volt = 50\nlevel_tolerance_rel = "
                 "0.01\nmaximum_voltage_v = 2.5\nmaximum_level_m_s2 = 100\n");
  ASSERT_TRUE(bench) << bench.error().message;
  EXPECT_EQ(bench->generator.level_tolerance_rel, 0.01);
  EXPECT_EQ(bench->generator.maximum_voltage_v, 2.5);
  EXPECT_EQ(bench->generator.maximum_level_m_s2, 100.0);
}

TEST(GeneratorTable, LimitsMayBeAbsent) {
  const auto bench = bench_with("driver = \"by-hand\"\nlevel_per_volt = 50.0\n");
  ASSERT_TRUE(bench) << bench.error().message;
  EXPECT_EQ(bench->generator.driver, GeneratorDriver::by_hand);
  EXPECT_FALSE(bench->generator.level_tolerance_rel);
  EXPECT_FALSE(bench->generator.maximum_voltage_v);
}

TEST(GeneratorTable, RefusesWhatCannotBe) {
  const auto negative = bench_with(
      "driver = \"scpi\"\naddress = \"a:1\"\nlevel_per_volt = 50\nmaximum_voltage_v = -1\n");
  ASSERT_FALSE(negative);
  EXPECT_THAT(negative.error().message, HasSubstr("maximum_voltage_v' must be positive"));
  const auto loop_by_hand =
      bench_with("driver = \"by-hand\"\nlevel_per_volt = 50\nlevel_tolerance_rel = 0.01\n");
  ASSERT_FALSE(loop_by_hand);
  EXPECT_THAT(loop_by_hand.error().message, HasSubstr("needs driver = \"scpi\""));
  const auto no_address = bench_with("driver = \"scpi\"\nlevel_per_volt = 50\n");
  ASSERT_FALSE(no_address);
  EXPECT_THAT(no_address.error().message, HasSubstr("'generator.address' is missing"));
  const std::string loop =
      "driver = \"scpi\"\naddress = \"a:1\"\nlevel_per_volt = 50\nlevel_tolerance_rel = 0.01\n";
  const auto from_data = bench_with(loop, "settling = \"from-data\"\n");
  ASSERT_FALSE(from_data);
  EXPECT_THAT(from_data.error().message, HasSubstr("cannot go with excitation.settling"));
}

// A level per volt that was only assumed drives the exciter by its factor too hard.
TEST(GeneratorTable, AsksForTheLevelPerVoltWhereAVoltageIsSet) {
  for (const std::string driver :
       {"driver = \"scpi\"\naddress = \"a:1\"\n", "driver = \"by-hand\"\n"}) {
    const auto refused = bench_with(driver);
    ASSERT_FALSE(refused) << driver;
    EXPECT_THAT(refused.error().message, HasSubstr("key 'generator.level_per_volt' is missing"));
  }
  EXPECT_TRUE(bench_with("driver = \"none\"\n"));
}

} // namespace
} // namespace dyncal::inline bench
