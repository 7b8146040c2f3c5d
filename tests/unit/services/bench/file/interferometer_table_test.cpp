#include "services/bench/file/interferometer_table.hpp"

#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

// A bench of a socket at 500 kS/s; `keys` of the interferometer, from line 23 on.
std::string bench(const std::string& keys) {
  return fmt::format(R"(bench = "laser"
[excitation]
frequencies_hz = ["80"]
level = 10.0
settling_s = 1.0
duration_s = 1.0
[sources.dau]
driver = "smartup"
sensor = "0xbccb0100"
[sources.acs]
driver = "socket"
address = "127.0.0.1:4000"
nominal_rate_hz = 500000
channels = {{ ai0 = "u1", ai1 = "u2" }}
ranges = {{ u1 = "-1 to 1", sync = "-10 to 10" }}
[method]
kind = "sample-timestamping"
reference = "acs/displacement"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
[sources.acs.interferometer]
{}
)",
                     keys);
}

Expected<BenchFile> read(const std::string& keys,
                         const std::filesystem::path& folder = ".") {
  return parse_bench_file(bench(keys), folder / "bench.toml");
}

std::string problem(const std::string& keys) {
  const auto file = read(keys);
  return file ? "accepted" : file.error().message;
}

const std::string pair = "u1 = \"u1\"\nu2 = \"u2\"\n";

TEST(InterferometerTable, HasDefaults) {
  const auto file = read(pair);
  ASSERT_TRUE(file) << file.error().message;
  const SourceSettings& source = *file->source("acs");
  ASSERT_TRUE(source.interferometer);
  const auto& settings = *source.interferometer;
  EXPECT_EQ(settings.channel, "displacement");
  EXPECT_NEAR(settings.displacement_per_turn_m, 0.5 * 632.8191e-9, 1e-13);
  EXPECT_GT(settings.u_wavelength_rel, 5e-6); // nobody measures the air
  EXPECT_LT(settings.u_wavelength_rel, 1e-5);
  EXPECT_FALSE(settings.ellipse);
  EXPECT_FALSE(settings.detector_bandwidth_hz);
  EXPECT_TRUE(settings.record.empty());
  EXPECT_EQ(source.nominal_rate_hz, 100e3); // that is published
  ASSERT_TRUE(settings.range_u1);
  EXPECT_EQ(settings.range_u1->high, 1.0);
  EXPECT_EQ(source.identity.ranges.size(), 1U);
}

TEST(InterferometerTable, TakesEverything) {
  const auto file = read(pair + R"(channel = "s"
direction = -1
passes = 2
wavelength_vacuum_nm = 632.9908
air = { temperature_degc = 23.0, pressure_pa = 101325.0, humidity_rel = 0.5, u_temperature_k = 0.1, u_pressure_pa = 50.0, u_humidity_rel = 0.05 }
u_wavelength_rel = 2e-8
detector_bandwidth_hz = 5e6
u_skew_s = 2e-9
output_rate_hz = 50000
record = "pairs"
)");
  ASSERT_TRUE(file) << file.error().message;
  const auto& settings = *file->source("acs")->interferometer;
  EXPECT_EQ(settings.channel, "s");
  EXPECT_NEAR(settings.displacement_per_turn_m, -0.25 * 632.8211e-9, 1e-13);
  EXPECT_LT(settings.u_wavelength_rel, 3e-7);
  EXPECT_EQ(settings.detector_bandwidth_hz, 5e6);
  EXPECT_EQ(settings.u_skew_s, 2e-9);
  EXPECT_EQ(file->source("acs")->nominal_rate_hz, 50e3);
  EXPECT_EQ(settings.record.filename(), "pairs");
  EXPECT_TRUE(file->named_files.empty()); // it is written
}

TEST(InterferometerTable, RefusesNonsenseWithLineAndKey) {
  EXPECT_THAT(problem("u1 = \"u1\"\n"), HasSubstr("'sources.acs.interferometer.u2'"));
  EXPECT_THAT(problem("u1 = \"u1\"\nu2 = \"u1\"\n"),
              HasSubstr("bench.toml:24: key 'sources.acs.interferometer.u2' names the channel of"));
  const auto with = [](const std::string& line) { return problem(pair + line + "\n"); };
  EXPECT_THAT(with("channel = \"u1\""), HasSubstr("bench.toml:25: key"));
  EXPECT_THAT(with("channel = \"a/b\""), HasSubstr("a name may hold"));
  EXPECT_THAT(with("direction = 0"), HasSubstr("must be 1 or -1"));
  EXPECT_THAT(with("passes = 0"), HasSubstr("interferometer.passes'"));
  EXPECT_THAT(with("passes = 9"), HasSubstr("must be from 1 to 8"));
  EXPECT_THAT(with("wavelength_nm = 632.8"), HasSubstr("u_wavelength_rel' is missing"));
  EXPECT_THAT(with("wavelength_vacuum_nm = 1550.0"), HasSubstr("u_wavelength_rel' is missing"));
  EXPECT_THAT(with("wavelength_vacuum_nm = 0.633"), HasSubstr("must be from 350 to 1600"));
  EXPECT_THAT(with("wavelength_nm = 632.8\nu_wavelength_rel = 1e-6\nair = {}"),
              HasSubstr("interferometer.air' is given, and wavelength_nm"));
  EXPECT_THAT(with("air = { pressure_pa = 1013.25 }"), HasSubstr("101325 Pa"));
  EXPECT_THAT(with("air = { humidity_rel = 50.0 }"), HasSubstr("50 % are 0.5"));
  EXPECT_THAT(with("air = { humidity = 0.5 }"), HasSubstr("did you mean 'humidity_rel'?"));
  EXPECT_THAT(with("u_wavelength_rel = 1.5"), HasSubstr("must be from 0 to 0.01"));
  EXPECT_THAT(with("output_rate_hz = 70000"), HasSubstr("divided by a whole number"));
  EXPECT_THAT(with("u_skew_s = -1e-9"), HasSubstr("must be from 0"));
  EXPECT_THAT(with("ellipse = \"none.toml\""), HasSubstr("is neither \"auto\" nor the file"));
  EXPECT_THAT(with("elipse = \"auto\""), HasSubstr("did you mean 'ellipse'?"));
}

TEST(InterferometerTable, IsForDevicesThatStreamAlone) {
  std::string text = bench(pair);
  text.replace(text.find("[sources.acs.interferometer]"), 28, "[sources.dau.interferometer]");
  const auto file = parse_bench_file(text, "bench.toml");
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, HasSubstr("'sources.dau.interferometer' is not known"));
}

const std::string ellipse_text = R"(p = 0.02
q = -0.015
R = 0.64
r = 1.05
alpha_rad = 0.0873
u_p = 1e-4
u_q = 1e-4
u_r = 2e-4
u_alpha_rad = 2e-4
periodic_error_rad = [0.0, 0.0, 0.0, 0.005]
turns_covered = 100
from = "an earlier day"
)";

TEST(InterferometerTable, TakesTheFileOfAnEllipse) {
  const TemporaryFolder folder;
  folder.write("ellipse.toml", ellipse_text);
  const auto file = read(pair + "ellipse = \"ellipse.toml\"\n", folder.path());
  ASSERT_TRUE(file) << file.error().message;
  const auto& stated = file->source("acs")->interferometer->ellipse;
  ASSERT_TRUE(stated);
  EXPECT_EQ(stated->ellipse.alpha_rad, 0.0873);
  EXPECT_NEAR(stated->u_rad[0], 1e-4 * std::hypot(1.0, 1.05) / 0.64, 1e-12);
  EXPECT_NEAR(stated->u_rad[1], 0.5 * std::hypot(2e-4 / 1.05, 2e-4), 1e-12);
  ASSERT_TRUE(stated->periodic_error_rad);
  EXPECT_EQ((*stated->periodic_error_rad)[3], 0.005);
  EXPECT_EQ(stated->from, "an earlier day");
  ASSERT_EQ(file->named_files.size(), 1U); // a run folder copies it
}

TEST(InterferometerTable, RefusesAWrongEllipseWithLineAndKey) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    std::string text = ellipse_text;
    text.replace(text.find(from), from.size(), to);
    const auto stated = parse_ellipse_file(text, "e.toml");
    return stated ? std::string("accepted") : stated.error().message;
  };
  EXPECT_EQ(refusal("p = ", "p = "), "accepted");
  EXPECT_THAT(refusal("R = 0.64", "R = 0.0"), HasSubstr("e.toml:3: key 'R' must be positive"));
  EXPECT_THAT(refusal("alpha_rad = 0.0873\n", "alpha_rad = 5.0\n"), HasSubstr("in degrees?"));
  EXPECT_THAT(refusal("u_p = 1e-4", "u_p = -1e-4"), HasSubstr("must not be negative"));
  EXPECT_THAT(refusal("u_q = 1e-4\n", ""), HasSubstr("'u_q' is missing"));
  EXPECT_THAT(refusal("[0.0, 0.0, 0.0, 0.005]", "[0.0]"), HasSubstr("must be four amplitudes"));
  EXPECT_THAT(refusal("turns_covered", "turns"), HasSubstr("'turns' is not known"));
}

} // namespace
} // namespace dyncal::tests
