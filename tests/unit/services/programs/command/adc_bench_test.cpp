#include "services/programs/command/adc_bench.hpp"

#include <gmock/gmock.h>

namespace dyncal::inline programs {
namespace {

using ::testing::HasSubstr;

std::string bench_text(const std::string& dau_time_base, const std::string& acs_time_base,
                       int repetitions = 3) {
  return R"(bench = "acc-1"
[excitation]
frequencies_hz = ["10", "12.5"]
level = [2.0, 4.0]
repetitions = )" +
         std::to_string(repetitions) + R"(
settling_s = 0.5
duration_s = 2.0
[generator]
driver = "scpi"
address = "127.0.0.1:1"
level_per_volt = 50.0
[sources.dau]
driver = "smartup"
sensor = "0xbccb0100"
channels = { Data_11 = "sync" }
time_base = ")" +
         dau_time_base + R"("
[sources.acs]
driver = "socket"
address = "127.0.0.1:2"
time_base = ")" +
         acs_time_base + R"("
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
)";
}

BenchFile bench(const std::string& text) {
  const auto parsed = parse_bench_file(text, "bench.toml");
  EXPECT_TRUE(parsed) << parsed.error().message;
  return *parsed;
}

TEST(CalibrateAdc, AUnitInATimeOfItsOwnIsRefusedWithTheReason) {
  const auto checked = check_bench_for_adc(bench(bench_text("local", "utc")), false);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, HasSubstr("source 'dau' does not stamp in UTC"));
  EXPECT_THAT(checked.error().message, HasSubstr("only up to a delay"));
}

TEST(CalibrateAdc, AnInstrumentThatSaysItsTimeBaseItselfIsAskedLater) {
  EXPECT_TRUE(check_bench_for_adc(bench(bench_text("utc", "local")), false));
}

TEST(CalibrateAdc, OneRepetitionShowsNoScatter) {
  const auto checked = check_bench_for_adc(bench(bench_text("utc", "utc", 1)), false);
  ASSERT_FALSE(checked);
  EXPECT_THAT(checked.error().message, HasSubstr("repetitions must be at least 2"));
}

TEST(CalibrateAdc, APassTakesSyncForEverythingAndSetsTheVoltage) {
  const BenchFile file = bench(bench_text("utc", "utc"));
  const BenchFile pass = bench_of_adc_pass(file, 1.95);
  EXPECT_EQ(pass.method.reference.text(), "acs/sync");
  ASSERT_EQ(pass.method.dut.size(), 1U);
  EXPECT_EQ(pass.method.dut[0].text(), "dau/sync");
  EXPECT_FALSE(pass.corrections.adc);
  EXPECT_EQ(pass.excitation.levels_m_s2,
            (std::vector<double>{0.5 * 1.95 * 50.0, 0.5 * 1.95 * 50.0}));
  EXPECT_NE(pass.sha256, file.sha256);
  EXPECT_EQ(bench_of_adc_pass(file, {}).excitation.levels_m_s2, file.excitation.levels_m_s2);
}

} // namespace
} // namespace dyncal::inline programs
