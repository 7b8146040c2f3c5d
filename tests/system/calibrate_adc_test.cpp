// `dyncal calibrate adc` on a live bench: finds the response that the bench's ADC has, and a run
// with the written file meets the truth.
#include <cmath>
#include <map>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using testing::HasSubstr;

const LiveBenchSettings utc_bench{.bench_arguments = {"--speed", "max", "--seed", "11",
                                                      "--frequencies", "20,80,200", "--levels",
                                                      "20", "--acs-utc", "--sync-is-first-output"},
                                  .excitation = "frequencies_hz = [\"20\", \"80\", \"200\"]\nlevel "
                                                "= 20.0\nrepetitions = 3\nsettling_s = 0.3\n"
                                                "duration_s = 2.0\n",
                                  .rest = ""};

void expect_the_adc_of_the_bench(const nlohmann::json& file, const nlohmann::json& truth) {
  const double gain = truth["drawn"]["adc_gain"];
  const double lag_s = truth["drawn"]["adc_lag_s"];
  int compared = 0;
  for (const auto& [key, rows] : file["FitResults"]["ADC1"].items()) {
    std::map<double, std::vector<double>> gains, lags;
    for (const auto& row : rows) {
      gains[row["TestAmplVPP."]].push_back(row["Amplitude"]);
      lags[row["TestAmplVPP."]].push_back(row["Phase"]);
    }
    const double w = 2.0 * std::numbers::pi * std::stod(key);
    for (const auto& [vpp, values] : lags) {
      ASSERT_EQ(values.size(), 3U);
      const auto mean_and_u = [](const std::vector<double>& v) {
        const double mean = (v[0] + v[1] + v[2]) / 3.0;
        const double squares =
            std::pow(v[0] - mean, 2) + std::pow(v[1] - mean, 2) + std::pow(v[2] - mean, 2);
        return std::pair(mean, std::sqrt(squares / 2.0 / 3.0));
      };
      // Three values know their scatter badly: the noise of the 12 bits over 2 s is a lower bound
      // of it.
      const double noise = std::sqrt(2.0 / 2000.0) * 6e-3 / (0.5 * vpp);
      const auto [lag, u_lag] = mean_and_u(values);
      const double time_scale = w * 40e-9; // of the virtual unit's clock over a step
      EXPECT_NEAR(lag, w * lag_s,
                  4.0 * std::sqrt(std::pow(std::max(u_lag, noise), 2) + time_scale * time_scale))
          << key << " Hz, " << vpp;
      const auto [amplitude, u_amplitude] = mean_and_u(gains[vpp]);
      EXPECT_NEAR(amplitude, gain, 4.0 * std::max(u_amplitude, gain * noise))
          << key << " Hz, " << vpp;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 6);
}

TEST(CalibrateAdc, FindsTheResponseOfTheAdcAndARunWithItMeetsTheTruth) {
  const auto folder = fresh_folder("calibrate-adc");
  LiveBench bench(folder, utc_bench);
  ProgramRun& calibration = bench.start({"calibrate", "adc", bench.bench_file(), "--amplitudes",
                                         "19.5,1.95", "--output", folder / "adc.json"});
  ASSERT_EQ(calibration.wait(patience), 0) << calibration.errors();
  EXPECT_THAT(calibration.output(), HasSubstr("adc = { file = \"adc.json\", channel = \"ADC1\", "
                                              "phase_sign = \"lag\", test_amplitude_vpp = 19.5 }"));
  expect_the_adc_of_the_bench(read_json(folder / "adc.json"), bench.truth());

  const auto corrected =
      bench.changed_bench_file("corrected.toml", "[uncertainty]",
                               "[corrections]\nadc = { file = \"adc.json\", channel = \"ADC1\", "
                               "phase_sign = \"lag\", test_amplitude_vpp = 1.95 }\n[uncertainty]");
  ProgramRun& run = bench.start({"run", corrected, "--output", folder / "result.json"});
  ASSERT_EQ(run.wait(patience), 0) << run.errors();
  std::map<std::pair<std::string, double>, nlohmann::json> measured;
  const nlohmann::json result = read_json(folder / "result.json");
  for (const auto& point : result["transfer_function"]) {
    measured[{point["channel"], point["frequency_hz"]}] = point;
  }
  const nlohmann::json truth = bench.truth();
  for (const auto& point : truth["transfer_function"]) {
    const auto& found =
        measured[{"dau/" + point["channel"].get<std::string>(), point["frequency_hz"]}];
    ASSERT_FALSE(found.is_null()) << point;
    const double phase =
        std::remainder(found["phase_rad"].get<double>() - point["phase_rad"].get<double>(),
                       2.0 * std::numbers::pi);
    EXPECT_LE(std::abs(phase), 4.0 * found["u_phase_rad"].get<double>()) << point;
    EXPECT_NEAR(found["magnitude"].get<double>(), point["magnitude"].get<double>(),
                4.0 * found["u_magnitude"].get<double>())
        << point;
  }
}

TEST(CalibrateAdc, ClocksThatShareNothingAreRefused) {
  const auto folder = fresh_folder("calibrate-adc-local");
  LiveBenchSettings settings = utc_bench;
  std::erase(settings.bench_arguments, "--acs-utc");
  LiveBench bench(folder, settings);
  ProgramRun& calibration =
      bench.start({"calibrate", "adc", bench.bench_file(), "--output", folder / "adc.json"});
  EXPECT_EQ(calibration.wait(patience), 1) << calibration.errors();
  EXPECT_THAT(calibration.errors(), HasSubstr("source 'acs' does not stamp in UTC"));
  EXPECT_FALSE(std::filesystem::exists(folder / "adc.json"));
}

TEST(CalibrateAdc, AVoltageThatSyncDoesNotFollowIsSeen) {
  const auto folder = fresh_folder("calibrate-adc-second-output");
  LiveBenchSettings settings = utc_bench;
  std::erase(settings.bench_arguments, "--sync-is-first-output");
  settings.excitation = "frequencies_hz = [\"80\"]\nlevel = 20.0\nrepetitions = 2\nsettling_s = "
                        "0.3\nduration_s = 1.0\n";
  LiveBench bench(folder, settings);
  ProgramRun& calibration = bench.start({"calibrate", "adc", bench.bench_file(), "--amplitudes",
                                         "1.95", "--output", folder / "adc.json"});
  EXPECT_EQ(calibration.wait(patience), 1) << calibration.errors();
  EXPECT_THAT(calibration.errors(),
              HasSubstr("--amplitudes needs the generator's output itself as sync"));
}

} // namespace
} // namespace dyncal::tests
