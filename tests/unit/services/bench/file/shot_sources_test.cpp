// Bench files of series time stamping.
#include "services/bench/file/driver_tables.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/bench/file/bench_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

using testing::HasSubstr;

const std::string series_bench = R"(bench = "tss-1"
[excitation]
frequencies_hz = ["10"]
level = 10.0
[sources.dso]
driver = "oscilloscope"
address = "192.0.2.20:5555"
sync_input = 3
[sources.tss]
driver = "series"
path = "series"
[sources.acs]
driver = "socket"
address = "127.0.0.1:5026"
[method]
kind = "series-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dso = "dso/sync"
dut = ["tss/x", "tss/z"]
shots = 7
[corrections]
dso_delay = { value_s = 236e-9, u_s = 1e-9 }
)";

std::string with(const std::string& what, const std::string& by) {
  std::string text = series_bench;
  return text.replace(text.find(what), what.size(), by);
}

std::string problem_of(const std::string& text, const std::filesystem::path& path = "bench.toml") {
  const auto file = parse_bench_file(text, path);
  EXPECT_FALSE(file) << text;
  return file ? "" : file.error().message;
}

TEST(SeriesBench, ABenchOfSeriesTimeStampingIsRead) {
  const auto file = parse_bench_file(series_bench, "/bench/bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  const auto* oscilloscope = file->source("dso")->as<OscilloscopeSourceSettings>();
  ASSERT_NE(oscilloscope, nullptr);
  EXPECT_EQ(oscilloscope->address, "192.0.2.20:5555");
  EXPECT_EQ(oscilloscope->sync_input, 3);
  EXPECT_DOUBLE_EQ(oscilloscope->sync_range_v, 20.0);
  const auto* series = file->source("tss")->as<SeriesSourceSettings>();
  ASSERT_NE(series, nullptr);
  EXPECT_EQ(series->path, "/bench/series");
  EXPECT_EQ(file->method.sync_dau.text(), "dso/sync");
  EXPECT_EQ(file->method.shots, 7);
  EXPECT_TRUE(file->method.trigger_phase_correction);
  EXPECT_DOUBLE_EQ(file->corrections.dso_delay_s, 236e-9);
}

TEST(SeriesBench, TheCorrectionOfTheTriggerPhaseCanBeSwitchedOff) {
  const auto file = parse_bench_file(
      with("shots = 7", "shots = 7\ntrigger_phase_correction = false"), "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_FALSE(file->method.trigger_phase_correction);
}

TEST(SeriesBench, RolesOfTheWrongKindOfSourceAreRefused) {
  EXPECT_THAT(problem_of(with("\"dso/sync\"", "\"tss/sync\"")),
              HasSubstr("must have driver = \"oscilloscope\""));
  EXPECT_THAT(problem_of(with("\"tss/z\"", "\"acs/z\"")),
              HasSubstr("must have driver = \"series\""));
  EXPECT_THAT(problem_of(with("dut = [\"tss/x\", \"tss/z\"]\n", "")), HasSubstr("dut"));
  EXPECT_THAT(problem_of(with("sync_acs = \"acs/sync\"", "sync_acs = \"dso/sync\"")),
              HasSubstr("share a clock"));
}

TEST(SeriesBench, ASensorHasAnAddressOrAFolderAndNotBoth) {
  EXPECT_THAT(
      problem_of(with("path = \"series\"", "path = \"series\"\naddress = \"127.0.0.1:5027\"")),
      HasSubstr("one of them"));
  EXPECT_THAT(problem_of(with("path = \"series\"", "")), HasSubstr("one of them"));
}

TEST(SeriesBench, NumbersThatCannotBeAreRefused) {
  EXPECT_THAT(problem_of(with("shots = 7", "shots = 0")), HasSubstr("shots"));
  EXPECT_THAT(problem_of(with("shots = 7", "shots = 100000")), HasSubstr("1000 at most"));
  EXPECT_THAT(problem_of(with("u_s = 1e-9", "u_s = -1e-9")), HasSubstr("must not be negative"));
}

TEST(SeriesBench, TheDelayComesFromTheFileOfItsCalibration) {
  const tests::TemporaryFolder own;
  const std::filesystem::path& folder = own.path();
  std::ofstream(folder / "delay.json")
      << R"({"instrument": "scope", "value_s": 2.365e-7, "u_s": 3e-10, "shots": 50})";
  const std::string text = with("{ value_s = 236e-9, u_s = 1e-9 }", "{ file = \"delay.json\" }");
  const auto file = parse_bench_file(text, folder / "bench.toml");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_DOUBLE_EQ(file->corrections.dso_delay_s, 2.365e-7);
  EXPECT_DOUBLE_EQ(file->corrections.u_dso_delay_s, 3e-10);

  for (const char* bad : {"", "[]", R"({"value_s": 1})", R"({"value_s": "1", "u_s": 1})",
                          R"({"value_s": 1, "u_s": -1})"}) {
    std::ofstream(folder / "delay.json") << bad;
    EXPECT_THAT(problem_of(text, folder / "bench.toml"), HasSubstr("delay.json")) << bad;
  }
  std::filesystem::remove(folder / "delay.json");
  EXPECT_THAT(problem_of(text, folder / "bench.toml"), HasSubstr("cannot be read"));
  EXPECT_THAT(
      problem_of(with("{ value_s", "{ file = \"delay.json\", value_s"), folder / "bench.toml"),
      HasSubstr("the file says both"));
}

} // namespace
} // namespace dyncal::inline bench
