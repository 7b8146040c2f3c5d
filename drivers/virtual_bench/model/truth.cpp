#include "drivers/virtual_bench/model/truth.hpp"

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>

namespace dyncal::drivers::virtual_bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double adc_gain_scatter = 1.5e-5; // relative
constexpr double adc_phase_scatter_rad = 2e-5;
constexpr std::uint32_t board_id = 0xbccb0000;

double to_hz(const std::string& decimal) {
  return std::strtod(decimal.c_str(), nullptr);
}

std::string axis_name(std::size_t axis) {
  return std::string("acceleration_") + "xyz"[axis];
}

Json transfer_function(const Preset& preset, const std::vector<std::string>& frequencies_hz) {
  Json points = Json::array();
  for (std::size_t axis = preset.triggered ? 2 : 0; axis < preset.axes.size();
       ++axis) { // a time series sensor measures z alone
    for (const std::string& text : frequencies_hz) {
      const std::complex<double> value = preset.axes[axis].at(to_hz(text));
      points.push_back({{"channel", axis_name(axis)},
                        {"frequency_text_hz", text},
                        {"frequency_hz", to_hz(text)},
                        {"magnitude", std::abs(value)},
                        {"phase_rad", std::arg(value)}});
    }
  }
  return points;
}

Json group_delay(const Preset& preset) {
  Json delays = Json::array();
  for (std::size_t axis = 0; axis < preset.axes.size(); ++axis) {
    delays.push_back({{"channel", axis_name(axis)}, {"value_s", preset.axes[axis].delay_s}});
  }
  return delays;
}

Json drawn_errors(const VirtualBench& bench) {
  return {{"reference_gain_error", bench.acs().reference_gain_error()},
          {"reference_phase_error_rad", bench.acs().reference_phase_error_rad()},
          {"acs_rate_error", bench.acs().rate_error()},
          {"acs_origin_ns", bench.acs().stamp_ns(0)},
          {"unit_start_ns", bench.unit().clock().start_ns()},
          {"unit_crystal_error", bench.unit().clock().crystal_error()},
          {"adc_gain", bench.adc().gain},
          {"adc_lag_s", bench.adc().lag_s},
          {"second_harmonic", bench.exciter().second_harmonic},
          {"third_harmonic", bench.exciter().third_harmonic}};
}

Json drawn_optics(const Interferometer& interferometer) {
  const InterferometerTruth& truth = interferometer.truth();
  const TableDrift& drift = interferometer.drift();
  Json motions = Json::array();
  for (const SlowMotion& motion : drift.motions()) {
    motions.push_back({{"amplitude_m", motion.amplitude_m},
                       {"frequency_hz", motion.frequency_hz},
                       {"phase_rad", motion.phase_rad}});
  }
  return {{"p_v", truth.p_v},
          {"q_v", truth.q_v},
          {"radius_v", truth.radius_v},
          {"r", truth.r},
          {"alpha_rad", truth.alpha_rad},
          {"wavelength_m", truth.wavelength_m},
          {"phase_0_rad", truth.phase_0_rad},
          {"detector_delay_s", truth.detector_delay_s},
          {"skew_s", truth.skew_s},
          {"table_drift_m_s", drift.velocity_m_s()},
          {"table_motions", motions}};
}

} // namespace

std::string truth_json(const VirtualBench& bench, const std::vector<std::string>& frequencies_hz) {
  const BenchSettings& settings = bench.settings();
  const Preset& preset = settings.preset;
  Json truth = {{"preset", preset.name},
                {"seed", settings.seed},
                {"transfer_function", transfer_function(preset, frequencies_hz)},
                {"group_delay", group_delay(preset)},
                {"sample_clock",
                 {{"mean_interval_s", preset.mean_interval_s},
                  {"sd_s", preset.interval_sd_s},
                  {"nominal_rate_hz", preset.nominal_rate_hz},
                  {"thermal_cycle_s", settings.thermal_cycle_s}}},
                {"range_m_s2", bench.unit().range_m_s2()},
                {"level_per_volt", VirtualBench::level_per_volt},
                {"uncertainty",
                 {{"reference_magnitude_rel", settings.reference_magnitude_rel},
                  {"reference_phase_rad", settings.reference_phase_rad}}},
                {"drawn", drawn_errors(bench)}};
  if (const auto& interferometer = bench.acs().interferometer()) {
    truth["interferometer"] = drawn_optics(*interferometer);
  }
  return truth.dump(2) + "\n";
}

std::string adc_calibration_json(const VirtualBench& bench,
                                 const std::vector<std::string>& frequencies_hz) {
  Random random(bench.settings().seed, "ADC calibration");
  Json frequencies = Json::object();
  for (const std::string& text : frequencies_hz) {
    const double frequency_hz = to_hz(text);
    Json rows = Json::array();
    for (int row = 0; row < 3; ++row) {
      const double amplitude = bench.adc().gain * (1.0 + random.normal(adc_gain_scatter));
      const double lag_rad = 2.0 * std::numbers::pi * frequency_hz * bench.adc().lag_s +
                             random.normal(adc_phase_scatter_rad);
      rows.push_back({{"Freq", frequency_hz},
                      {"Amplitude", amplitude},
                      {"Phase", lag_rad},
                      {"TestAmplVPP.", 19.5}});
    }
    frequencies[Json(frequency_hz).dump()] = rows;
  }
  const Json file = {{"MeataData", {{"BordID", board_id}, {"Date", "2021-09-17 00:00:00"}}},
                     {"FitResults", {{"ADC1", frequencies}}}};
  return file.dump(1) + "\n";
}

} // namespace dyncal::drivers::virtual_bench
