#include "services/bench/file/excitation_levels.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <fmt/core.h>
#include <gmock/gmock.h>

#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Expected<BenchFile> bench_with(const std::string& lines, const std::string& frequencies) {
  return parse_bench_file(fmt::format(R"(bench = "b"
[excitation]
frequencies_hz = {}
{}
[sources.acs]
driver = "socket"
address = "127.0.0.1:5026"
[sources.dau]
driver = "smartup"
listen = "127.0.0.1:7654"
sensor = "0xbccb0100"
[method]
kind = "sample-timestamping"
reference = "acs/reference"
sync_acs = "acs/sync"
sync_dau = "dau/sync"
dut = ["dau/acceleration_z"]
)",
                                      frequencies, lines),
                          "bench.toml");
}

std::vector<double> levels(const std::string& lines,
                           const std::string& frequencies = R"(["10", "80", "200"])") {
  const auto file = bench_with(lines, frequencies);
  EXPECT_TRUE(file) << file.error().message;
  return file ? file->excitation.levels_m_s2 : std::vector<double>{};
}

std::string problem(const std::string& lines) {
  const auto file = bench_with(lines, R"(["10", "80", "200"])");
  EXPECT_FALSE(file) << lines;
  return file ? "" : file.error().message;
}

TEST(ExcitationLevels, FollowFromAVelocityOrADisplacement) {
  EXPECT_THAT(levels("level_velocity_m_s = 0.1"), ElementsAre(6.283, 50.26, 125.6));
  EXPECT_THAT(levels("level_displacement_mm = 1.0"), ElementsAre(3.947, 252.6, 1579.0));
  EXPECT_THAT(levels("level_velocity_m_s = [0.1, 0.2, 0.05]"), ElementsAre(6.283, 100.5, 62.83));
}

TEST(ExcitationLevels, AreTheLeastOfWhatIsAskedFor) {
  EXPECT_THAT(levels("level = 60\nlevel_velocity_m_s = 0.1\nlevel_displacement_mm = 1"),
              ElementsAre(3.947, 50.26, 60.0));
}

TEST(ExcitationLevels, StayWithinWhatWasAskedForAndCloseToIt) {
  std::mt19937_64 random(38);
  std::uniform_real_distribution<double> exponent(-3.0, 1.0);
  for (int i = 0; i < 1000; ++i) {
    const double velocity_m_s = std::pow(10.0, exponent(random));
    const auto level = levels(fmt::format("level_velocity_m_s = {}", velocity_m_s), R"(["40"])");
    ASSERT_EQ(level.size(), 1U);
    const double exact = velocity_m_s * 2.0 * std::numbers::pi * 40.0;
    EXPECT_LE(level.front(), exact * (1.0 + 1e-11));
    EXPECT_GT(level.front(), exact * (1.0 - 1.1e-3));
    EXPECT_EQ(fmt::format("{:.4g}", level.front()), fmt::format("{:g}", level.front()));
  }
}

TEST(ExcitationLevels, RefuseWhatIsNone) {
  EXPECT_THAT(problem(""), HasSubstr("'excitation.level' is missing"));
  EXPECT_THAT(problem("level_velocity_m_s = 0"), HasSubstr("must be positive, in m/s"));
  EXPECT_THAT(problem("level_displacement_mm = [1, -1, 1]"), HasSubstr("must be positive, in mm"));
  EXPECT_THAT(problem("level = 10\nlevel_velocity_m_s = [0.1, 0.2]"),
              HasSubstr("lists 2 levels for 3 frequencies"));
}

} // namespace
} // namespace dyncal::inline bench
