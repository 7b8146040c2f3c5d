#include "services/bench/file/adc_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "services/bench/file/adc_file_writer.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline bench {
namespace {

AdcCorrectionSettings settings_for(const std::string& channel,
                                   const std::filesystem::path& file = {},
                                   PhaseSign sign = PhaseSign::lag,
                                   std::optional<double> test_amplitude_vpp = std::nullopt) {
  AdcCorrectionSettings settings;
  settings.file = file;
  settings.channel = channel;
  settings.phase_sign = sign;
  settings.test_amplitude_vpp = test_amplitude_vpp;
  return settings;
}

class AdcFile : public testing::Test {
protected:
  Expected<std::vector<analysis::AdcCalibrationPoint>>
  read(const std::string& text, AdcCorrectionSettings settings = settings_for("ADC1")) {
    std::ofstream(path_) << text;
    settings.file = path_;
    return read_adc_file(settings);
  }

  const tests::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "adc.json";
};

const std::string frequencies = R"({
  "10.0": [{"Freq": 10.0, "Amplitude": 0.16621, "Phase": 3e-5, "TestAmplVPP.": 19.5},
           {"Freq": 10.0, "Amplitude": 0.16623, "Phase": 5e-5, "TestAmplVPP.": 19.5}],
  "100.0": [{"Freq": 100.0, "Amplitude": 0.16624, "Phase": 2.9e-4, "TestAmplVPP.": 19.5},
            {"Freq": 100.0, "Amplitude": 0.16626, "Phase": 3.1e-4, "TestAmplVPP.": 19.5}]})";

void expect_the_two_points(const Expected<std::vector<analysis::AdcCalibrationPoint>>& points,
                           double sign = 1.0) {
  ASSERT_TRUE(points.has_value()) << points.error().message;
  ASSERT_EQ(points->size(), 2u);
  EXPECT_EQ((*points)[0].frequency_hz, 10.0);
  EXPECT_NEAR((*points)[0].gain, 0.16622, 1e-15);
  EXPECT_NEAR((*points)[0].phase_lag_rad, sign * 4e-5, 1e-18);
  EXPECT_EQ((*points)[1].frequency_hz, 100.0);
  EXPECT_NEAR((*points)[1].phase_lag_rad, sign * 3e-4, 1e-18);
  EXPECT_NEAR((*points)[1].u_phase_lag_rad, 1e-5,
              1e-16); // pooled standard deviation 1.41e-5, of the mean of two
}

TEST_F(AdcFile, ReadsAllThreeVariants) {
  expect_the_two_points(read(R"({"MeataData": {"BordID": 1}, "FitResults": {"ADC1": )" +
                             frequencies + R"(, "ADC2": {}}})"));
  expect_the_two_points(read(R"({"ADC1": )" + frequencies + "}"));
  expect_the_two_points(read(frequencies));
}

TEST_F(AdcFile, TakesThePhaseWithTheSignTheBenchFileSays) {
  expect_the_two_points(read(frequencies, settings_for("ADC1", {}, PhaseSign::lead)), -1.0);
}

const std::string two_amplitudes = R"({"ADC1": {
  "10.0": [{"Freq": 10.0, "Amplitude": 0.1662, "Phase": 3e-5, "TestAmplVPP.": 19.5},
           {"Freq": 10.0, "Amplitude": 0.1701, "Phase": 4e-5, "TestAmplVPP.": 1.95}],
  "20.0": [{"Freq": 20.0, "Amplitude": 0.1663, "Phase": 6e-5, "TestAmplVPP.": 19.5},
           {"Freq": 20.0, "Amplitude": 0.1702, "Phase": 8e-5, "TestAmplVPP.": 1.95}]}})";

TEST_F(AdcFile, NeverMixesTestAmplitudes) {
  const auto undecided = read(two_amplitudes);
  ASSERT_FALSE(undecided.has_value());
  EXPECT_NE(undecided.error().message.find("test_amplitude_vpp"), std::string::npos);
  const auto large = read(two_amplitudes, settings_for("ADC1", {}, PhaseSign::lag, 20.0));
  ASSERT_TRUE(large.has_value());
  ASSERT_EQ(large->size(), 2u);
  EXPECT_EQ((*large)[0].gain, 0.1662);
  EXPECT_FALSE(read(two_amplitudes, settings_for("ADC1", {}, PhaseSign::lag, 0.2)).has_value());
}

TEST_F(AdcFile, SaysWhatIsWrong) {
  EXPECT_NE(read("no json").error().message.find("is no JSON"), std::string::npos);
  const auto channel = read(R"({"FitResults": {"ADC1": {}, "ADC2": {}}})", settings_for("ADC3"));
  EXPECT_NE(channel.error().message.find("no channel 'ADC3' (it has: ADC1, ADC2)"),
            std::string::npos)
      << channel.error().message;
  EXPECT_FALSE(
      read(
          R"({"ADC1": {"10.0": [{"Freq": 10.0, "Amplitude": "x", "Phase": 0, "TestAmplVPP.": 1}]}})")
          .has_value());
  EXPECT_FALSE(
      read(
          R"({"ADC1": {"10.0": [{"Freq": 10.0, "Amplitude": -1.0, "Phase": 0, "TestAmplVPP.": 1}]}})")
          .has_value());
  EXPECT_FALSE(read(R"({"ADC1": {"10.0": []}})").has_value());
  EXPECT_FALSE(read(R"({"ADC1": 5})").has_value());
  EXPECT_FALSE(read("[1, 2]").has_value());
  EXPECT_FALSE(read_adc_file(settings_for("ADC1", "does/not/exist.json")).has_value());
}

TEST_F(AdcFile, ReadsTheFilesOfThePublishedUnits) {
  const std::filesystem::path folder = DYNCAL_SHARED_DATA "/adc";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "the published calibration files are not beside the source tree";
  }
  const auto board =
      read_adc_file(settings_for("ADC1", folder / "201006_BCCB_ADC123_3CLCES_19V5_1HZ_1MHZ.json"));
  ASSERT_TRUE(board.has_value()) << board.error().message;
  EXPECT_EQ(board->size(), 51u);
  const auto response = analysis::adc_response_at(*board, 100.0);
  ASSERT_TRUE(response.has_value());
  EXPECT_NEAR(response->gain, 0.16625, 5e-5);
  EXPECT_NEAR(response->phase_lag_rad / (2.0 * std::numbers::pi * 100.0), 0.318e-6, 0.001e-6); // s
  EXPECT_LT(response->u_phase_lag_rad, 3e-5);
  const auto older =
      read_adc_file(settings_for("ADC1", folder / "200310_ADC1_AC_cal.json", PhaseSign::lead));
  ASSERT_TRUE(older.has_value()) << older.error().message;
  EXPECT_GT(analysis::adc_response_at(*older, 1000.0)->phase_lag_rad, 0.0);
}

TEST_F(AdcFile, ReadsWhatTheWriterWrites) {
  std::vector<analysis::AdcCalibrationPoint> measurements;
  for (const double vpp : {19.5, 1.95}) {
    for (const double frequency_hz : {12.5, 100.0, 199.87}) {
      const double lag_rad = 2.0 * std::numbers::pi * frequency_hz * 0.46e-6;
      for (const double sign : {-1.0, 1.0}) {
        measurements.push_back({frequency_hz, vpp, 0.16625 * (1.0 + sign * 1e-5),
                                lag_rad + sign * 2e-5, 3e-6, frequency_hz * 1e-7});
      }
    }
  }
  ASSERT_TRUE(write_adc_file(
      path_, {"ADC2", 0xbccb0000U, "2026-01-31 12:00:00", {{"Path", "data-ready"}}}, measurements));
  auto settings = settings_for("ADC2", path_, PhaseSign::lag, 1.95);
  const auto points = read_adc_file(settings);
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 3u);
  const auto& last = points->back();
  EXPECT_EQ(last.frequency_hz, 199.87);
  EXPECT_EQ(last.test_amplitude_vpp, 1.95);
  EXPECT_NEAR(last.gain, 0.16625, 1e-15);
  EXPECT_NEAR(last.phase_lag_rad, 2.0 * std::numbers::pi * 199.87 * 0.46e-6, 1e-15);
  EXPECT_NEAR(last.u_phase_lag_rad, std::hypot(2e-5, 199.87e-7), 1e-12);
  EXPECT_NEAR(last.u_gain, std::hypot(0.16625e-5, 3e-6), 1e-12);
  settings.channel = "ADC1";
  EXPECT_FALSE(read_adc_file(settings));
}

TEST_F(AdcFile, RefusesANegativeUncertainty) {
  EXPECT_FALSE(read(
      R"({"10.0": [{"Freq": 10.0, "Amplitude": 0.16621, "Phase": 3e-5, "TestAmplVPP.": 19.5, "u_Phase": -1e-5}]})"));
}

} // namespace
} // namespace dyncal::inline bench
