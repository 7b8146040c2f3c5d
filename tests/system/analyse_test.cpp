// dyncal analyse on records whose exact evaluation is known.
#include <cmath>
#include <numbers>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "tests/system/laboratory.hpp"

namespace dyncal::tests {
namespace {

double digits(const nlohmann::json& value) {
  return std::stod(value["digits"].get<std::string>());
}

// Eq. (4) with the exact least-squares answers of the four series.
double exact_phase_rad(const nlohmann::json& vector) {
  const auto& fits = vector["ls3"];
  const double lag = std::stod(vector["adc_correction_at_f"]["phase_lag_rad"].get<std::string>());
  return digits(fits["dos_dau"]["theta_rad"]) - (digits(fits["sync_dau"]["theta_rad"]) + lag) +
         digits(fits["sync_acs"]["theta_rad"]) - digits(fits["ref_acs"]["theta_rad"]);
}

std::filesystem::path bench_of_vector(const std::filesystem::path& folder,
                                      const std::filesystem::path& vectors,
                                      const nlohmann::json& vector) {
  const std::string frequency = vector["frequency_hz"];
  const auto& adc = vector["adc_correction_at_f"];
  std::ofstream(folder / "adc.json") << fmt::format(
      R"({{"ADC1": {{"{0}": [{{"Freq": {0}, "Amplitude": {1}, "Phase": {2}, "TestAmplVPP.": 19.5}}]}}}})",
      frequency, adc["gain"].get<std::string>(), adc["phase_lag_rad"].get<std::string>());
  const std::filesystem::path path = folder / "bench.toml";
  std::ofstream(path) << fmt::format(R"(bench = "vector"
[excitation]
frequencies_hz = ["{}"]
level = 10.0
window = "whole-record"
[sources.acs]
driver = "file"
path = "{}"
units = {{ ref = "m/s^2", sync = "V" }}
[sources.dau]
driver = "file"
path = "{}"
units = {{ dos = "m/s^2", sync_adc = "V" }}
[method]
kind = "sample-timestamping"
reference = "acs/ref"
sync_acs = "acs/sync"
sync_dau = "dau/sync_adc"
dut = ["dau/dos"]
frequency_search_rel = 0
[corrections.adc]
file = "adc.json"
channel = "ADC1"
)",
                                     frequency, (vectors / "07_sync_link_acs.csv").string(),
                                     (vectors / "07_sync_link_dau.csv").string());
  return path;
}

TEST(Analyse, MeetsTheExactAnswerOfTheSyncLink) {
  const std::filesystem::path vectors = DYNCAL_SHARED_VECTORS;
  if (!std::filesystem::exists(vectors)) {
    GTEST_SKIP() << "the laboratory's shared vectors are not at " << vectors;
  }
  const auto folder = fresh_folder("analyse-vector");
  const nlohmann::json vector = read_json(vectors / "07_sync_link.json");
  ProgramRun run(
      "dyncal",
      {"analyse", bench_of_vector(folder, vectors, vector), "--output", folder / "result.json"},
      folder);
  ASSERT_EQ(run.wait(patience), 0) << run.output() << run.errors();
  const nlohmann::json result = read_json(folder / "result.json");
  ASSERT_EQ(result["points"].size(), 1U);
  const auto& point = result["points"][0];
  EXPECT_EQ(point["samples"]["acs"], vector["ls3"]["ref_acs"]["dof"].get<int>() + 3);
  EXPECT_NEAR(std::remainder(point["phase_rad"].get<double>() - exact_phase_rad(vector),
                             2.0 * std::numbers::pi),
              0.0, 1e-11);
  const double magnitude =
      digits(vector["ls3"]["dos_dau"]["amplitude"]) / digits(vector["ls3"]["ref_acs"]["amplitude"]);
  EXPECT_NEAR(point["magnitude"].get<double>() / magnitude, 1.0, 1e-12);
}

} // namespace
} // namespace dyncal::tests
