// dyncal analyse on records whose channels are in units of the trade: g, scale factors, counts. One
// second of 20 Hz: the reference moves by 10 m/s^2, the sensor answers with 4.903325 m/s^2, which
// is half a g, 0.3 rad later: H = 0.4903325.
#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

struct UnitCase {
  const char* name;
  double sensor;           // amplitude in the file
  const char* sensor_at;   // heading of its column
  const char* sensor_unit; // of the bench file
  double reference;
  const char* reference_unit;
  double magnitude;
  const char* unit; // of H
};

const std::vector<UnitCase> cases{
    {"acceleration", 4.903325, "dos", "m/s^2", 10.0, "m/s^2", 0.4903325, R"(\one)"},
    {"g", 0.5, "dos", "g", 10.0, "m/s^2", 0.4903325, R"(\one)"},
    {"both_in_g", 0.5, "dos", "g", 10.0 / 9.80665, "g", 0.4903325, R"(\one)"},
    {"g_by_the_file", 0.5, "dos [g]", "", 10.0, "m/s^2", 0.4903325, R"(\one)"},
    {"scale_factor", 8192.0, "dos", "16384 LSB/g", 10.0, "m/s^2", 0.4903325, R"(\one)"},
    {"counts", 8192.0, "dos", "LSB", 10.0, "m/s^2", 819.2, "(1)/(m/s^2)"},
    {"millivolts", 0.5, "dos", "g", 1000.0 / 9.80665, "100 mV/g", 0.4903325, R"(\one)"},
    {"volts", 0.5, "dos", "g", 0.5, R"(50 mV/(m/s^2))", 490.3325, R"(\one)"},
};

void write_sines(const std::filesystem::path& path, const std::string& first, double amplitude,
                 double phase_rad) {
  std::ofstream file(path);
  file << "t_ns," << first << ",sync\n";
  for (int i = 0; i < 1000; ++i) {
    const double turn = 2.0 * std::numbers::pi * 0.02 * i;
    file << fmt::format("{},{:.15g},{:.15g}\n", 1'000'000LL * i,
                        amplitude * std::sin(turn + phase_rad), std::sin(turn));
  }
}

std::string units_line(const std::string& channel, const std::string& unit) {
  return unit.empty() ? "units = { sync = \"V\" }"
                      : fmt::format(R"(units = {{ {} = "{}", sync = "V" }})", channel, unit);
}

std::filesystem::path bench_of(const std::filesystem::path& folder, const UnitCase& one) {
  write_sines(folder / "acs.csv", "ref", one.reference, 0.0);
  write_sines(folder / "dau.csv", one.sensor_at, one.sensor, -0.3);
  const std::filesystem::path path = folder / "bench.toml";
  std::ofstream(path) << fmt::format(R"(bench = "units"
[excitation]
frequencies_hz = ["20"]
level = 10.0
window = "whole-record"
[sources.acs]
driver = "file"
path = "acs.csv"
{}
[sources.dau]
driver = "file"
path = "dau.csv"
{}
[method]
kind = "sample-timestamping"
reference = "acs/ref"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/dos"]
)",
                                     units_line("ref", one.reference_unit),
                                     units_line("dos", one.sensor_unit));
  return path;
}

TEST(ChannelUnits, GiveTheTransferFunctionInDsi) {
  for (const UnitCase& one : cases) {
    const auto folder = fresh_folder(fmt::format("channel-units-{}", one.name));
    ProgramRun run("dyncal", {"analyse", bench_of(folder, one), "--output", folder / "result.json"},
                   folder);
    ASSERT_EQ(run.wait(patience), 0) << one.name << run.output() << run.errors();
    const nlohmann::json result = read_json(folder / "result.json");
    ASSERT_EQ(result["points"].size(), 1U) << one.name;
    const nlohmann::json& point = result["points"][0];
    EXPECT_NEAR(point["magnitude"].get<double>() / one.magnitude, 1.0, 1e-9) << one.name;
    EXPECT_NEAR(point["phase_rad"].get<double>(), -0.3, 1e-9) << one.name;
    EXPECT_EQ(point["unit"], one.unit) << one.name;
  }
}

TEST(ChannelUnits, AreRefusedWhereNoConversionIsKnown) {
  const auto folder = fresh_folder("channel-units-refused");
  UnitCase one = cases.front();
  for (const auto& [unit, sentence] :
       {std::pair("dB", "is a logarithm"), std::pair("furlong", "is neither D-SI nor"),
        std::pair("0 LSB/g", "is neither D-SI nor")}) {
    one.sensor_unit = unit;
    ProgramRun run("dyncal", {"analyse", bench_of(folder, one)}, folder);
    EXPECT_NE(run.wait(patience), 0) << unit;
    EXPECT_THAT(run.errors(),
                testing::HasSubstr(fmt::format("the unit \"{}\", which {}", unit, sentence)));
    EXPECT_THAT(run.errors(), testing::HasSubstr("bench.toml:"));
  }
}

TEST(ChannelUnits, AreRefusedWhereTheFileSaysAnother) {
  const auto folder = fresh_folder("channel-units-contradicted");
  UnitCase one = cases[1];
  one.sensor_at = R"(dos [\metre\second\tothe{-2}])";
  ProgramRun run("dyncal", {"analyse", bench_of(folder, one)}, folder);
  EXPECT_NE(run.wait(patience), 0);
  EXPECT_THAT(run.errors(), testing::HasSubstr("'dos' is taken to be in g"));
}

} // namespace
} // namespace dyncal::tests
