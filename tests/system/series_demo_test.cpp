// Series time stamping as a whole: oscilloscope and time series sensor over TCP, their records over
// DDS, the result against the truth.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

constexpr const char* channel = "tss/acceleration_z";

struct Deviation {
  double magnitude_u = 0.0; // largest, in standard uncertainties
  double phase_u = 0.0;
  double min_phase_rad = 1e9; // least of all frequencies
  std::size_t points = 0;
};

Deviation deviation(const nlohmann::json& result, const nlohmann::json& truth) {
  Deviation worst;
  for (const auto& expected : truth["transfer_function"]) {
    for (const auto& point : result["transfer_function"]) {
      if (point["channel"] != channel || point["frequency_hz"] != expected["frequency_hz"]) {
        continue;
      }
      const double magnitude =
          point["magnitude"].get<double>() - expected["magnitude"].get<double>();
      const double phase =
          std::remainder(point["phase_rad"].get<double>() - expected["phase_rad"].get<double>(),
                         2.0 * std::numbers::pi);
      worst.magnitude_u =
          std::max(worst.magnitude_u, std::abs(magnitude) / point["u_magnitude"].get<double>());
      worst.phase_u = std::max(worst.phase_u, std::abs(phase) / point["u_phase_rad"].get<double>());
      worst.min_phase_rad = std::min(worst.min_phase_rad, std::abs(phase));
      ++worst.points;
    }
  }
  return worst;
}

class SeriesDemo : public testing::TestWithParam<const char*> {};

TEST_P(SeriesDemo, AgreesWithTheTruthInMagnitudePhaseAndSampleRate) {
  std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
  std::replace(name.begin(), name.end(), '/', '-');
  const auto folder = fresh_folder("series-demo-" + name);
  ProgramRun demo("dyncal",
                  {"demo", "--preset", "tss", "--dds", GetParam(), "--output", folder / "files"},
                  folder);
  const auto status = demo.wait(patience);
  ASSERT_TRUE(status) << "not ended within " << patience.count() << " s\n" << demo.errors();
  EXPECT_EQ(*status, 0) << demo.output() << demo.errors();

  const nlohmann::json result = read_json(folder / "files" / "result.json");
  const nlohmann::json truth = read_json(folder / "files" / "truth.json");
  ASSERT_FALSE(result.is_discarded() || truth.is_discarded());
  const Deviation worst = deviation(result, truth);
  EXPECT_EQ(worst.points, 6U);
  EXPECT_LE(worst.magnitude_u, 4.0);
  EXPECT_LE(worst.phase_u, 4.0);

  const double true_rate_hz = 1.0 / truth["sample_clock"]["mean_interval_s"].get<double>();
  for (const auto& point : result["points"]) {
    EXPECT_TRUE(point["valid"].get<bool>()) << point;
    EXPECT_EQ(point["flags"], nlohmann::json::array()) << point;
    EXPECT_EQ(point["series_start"], "with the trigger");
    EXPECT_LE(std::abs(point["sample_rate_hz"].get<double>() - true_rate_hz),
              4.0 * point["u_sample_rate_hz"].get<double>())
        << point;
    EXPECT_EQ(point["samples"]["tss"], 5 * 1000);
    EXPECT_EQ(point["samples"]["dso"], 5 * 10'000);
  }
  ASSERT_EQ(result["sample_clock"].size(), 1U);
  const auto& clock = result["sample_clock"][0];
  EXPECT_LE(std::abs(clock["mean_interval_s"].get<double>() - 1.0 / true_rate_hz),
            4.0 * clock["u_mean_interval_s"].get<double>());
}

INSTANTIATE_TEST_SUITE_P(
    BothVendorsAndMixed, SeriesDemo,
    testing::Values("fastdds", "cyclonedds",
                    "dau=cyclonedds,acs=fastdds,analysis=cyclonedds,run=fastdds",
                    "dau=fastdds,acs=cyclonedds,analysis=fastdds,run=cyclonedds"),
    [](const auto& vendors) { return "case" + std::to_string(vendors.index + 1); });

TEST(SeriesDemoWithoutCorrection, IsWrongByMoreThanTenMilliradians) {
  const auto folder = fresh_folder("series-demo-without");
  ProgramRun demo(
      "dyncal",
      {"demo", "--preset", "tss", "--no-trigger-correction", "--output", folder / "files"}, folder);
  EXPECT_EQ(demo.wait(patience), 1) << demo.output() << demo.errors();
  EXPECT_THAT(demo.errors(), testing::HasSubstr("does not agree with the truth"));
  const nlohmann::json result = read_json(folder / "files" / "result.json");
  const nlohmann::json truth = read_json(folder / "files" / "truth.json");
  ASSERT_FALSE(result.is_discarded() || truth.is_discarded());
  const Deviation worst = deviation(result, truth);
  EXPECT_EQ(worst.points, 6U);
  EXPECT_GT(worst.min_phase_rad, 0.010);
  EXPECT_LE(worst.magnitude_u, 4.0); // the trigger has no part in it
  for (const auto& point : result["points"]) {
    EXPECT_THAT(point["flags"].dump(),
                testing::HasSubstr("the phase of the trigger is not corrected"));
  }
}

} // namespace
} // namespace dyncal::tests
