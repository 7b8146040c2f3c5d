// A bench file that names its sensor: a run of one that the library lacks is refused before
// anything is excited; of one that it has, the run says whether it meets its tolerances, and
// documents need no sensor file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const std::string sensor_file = R"([sensor]
name = "digital accelerometer"
manufacturer = "Works"
model = "MPU-9250"
serial = "0xbccb0100"

[conformity]
specification = "data sheet 1"
rule = "simple-acceptance"

[[tolerance]]
channel = "dau/acceleration_z"
from_hz = 10.0
to_hz = 200.0
limits_percent = 10.0
nominal = 1.0
)";

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(NamedSensor, IsThatOfTheLibraryOrTheRunDoesNotBegin) {
  const auto folder = fresh_folder("named-sensor");
  LiveBenchSettings settings;
  settings.bench_arguments = {"--speed", "8"};
  settings.excitation = "frequencies_hz = [\"80\"]\nlevel = 10.0\nsettling_s = 0.5\n"
                        "duration_s = 1.0\n";
  LiveBench bench(folder, settings);
  const fs::path named = bench.changed_bench_file(
      "named.toml", "bench =", "bench = \"live\"\nsensor = \"0xbccb0100\"");

  ProgramRun& refused = bench.start({"run", named, "--folder", folder / "runs"});
  EXPECT_NE(refused.wait(patience), 0);
  EXPECT_THAT(refused.errors(), AllOf(HasSubstr("'0xbccb0100'"), HasSubstr("dyncal sensor add")));
  EXPECT_EQ(bench.ask_generator(":OUTPut1?"), "OFF");

  std::ofstream(folder / "sensor.toml") << sensor_file;
  ProgramRun add("dyncal", {"sensor", "add", folder / "sensor.toml", "--folder", folder / "runs"},
                 folder);
  ASSERT_EQ(add.wait(patience), 0) << add.errors();
  ProgramRun& run = bench.start({"run", named, "--folder", folder / "runs"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  EXPECT_THAT(run.output(), HasSubstr("data sheet 1: pass (1 pass)"));
  const fs::path kept = fs::directory_iterator(folder / "runs" / "live")->path();
  EXPECT_TRUE(fs::exists(kept / "conformity.json"));
  ProgramRun& other = bench.start({"run", named, "--folder", folder / "runs", "--sensor", "SN-9"});
  EXPECT_NE(other.wait(patience), 0); // the command's stands above the bench file's
  EXPECT_THAT(other.errors(), HasSubstr("'SN-9'"));

  ProgramRun report("dyncal", {"report", kept, "--received", "2026-03-01", "--no-pdf"}, folder);
  ASSERT_EQ(report.wait(patience), 0) << report.errors();
  EXPECT_THAT(text_of(kept / "report.html"),
              AllOf(HasSubstr("Works"), HasSubstr("data sheet 1"), HasSubstr("2026-03-01")));
}

} // namespace
} // namespace dyncal::tests
