#include "services/bench/file/adc_file.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dyncal::inline bench {
namespace {

using Json = nlohmann::json;
using Points = std::vector<analysis::AdcCalibrationPoint>;

tl::unexpected<Error> bad_file(const AdcCorrectionSettings& settings, const std::string& what) {
  return fail(ErrorCode::bad_file,
              fmt::format("{}: ADC calibration {}", settings.file.string(), what));
}

const Json* member(const Json& object, const std::string& key) {
  if (!object.is_object()) {
    return nullptr;
  }
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

const Json& without_level(const Json& object, const char* key) {
  const Json* inner = member(object, key);
  return inner ? *inner : object;
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0';
}

// Frequencies of one ADC: an object whose keys are numbers.
bool holds_frequencies(const Json& object) {
  return object.is_object() && !object.empty() &&
         std::all_of(object.items().begin(), object.items().end(),
                     [](const auto& item) { return is_number(item.key()); });
}

Expected<const Json*> frequencies_of_channel(const Json& file,
                                             const AdcCorrectionSettings& settings) {
  const Json& results = without_level(file, "FitResults");
  if (holds_frequencies(results)) {
    return &results;
  }
  const Json* channel = member(results, settings.channel);
  if (!channel) {
    std::string known;
    if (results.is_object()) {
      for (const auto& item : results.items()) {
        known += (known.empty() ? "" : ", ") + item.key();
      }
    }
    return bad_file(settings,
                    fmt::format("has no channel '{}' (it has: {})", settings.channel, known));
  }
  const Json& frequencies = without_level(*channel, "FitResults");
  if (!holds_frequencies(frequencies)) {
    return bad_file(settings, fmt::format("has no frequencies for channel '{}'", settings.channel));
  }
  return &frequencies;
}

std::optional<double> number(const Json& measurement, const std::string& key) {
  const Json* value = member(measurement, key);
  if (!value || !value->is_number()) {
    return std::nullopt;
  }
  return value->get<double>();
}

Expected<analysis::AdcCalibrationPoint> read_measurement(const Json& measurement,
                                                         const AdcCorrectionSettings& settings,
                                                         const std::string& frequency) {
  const auto frequency_hz = number(measurement, "Freq");
  const auto gain = number(measurement, "Amplitude");
  const auto phase = number(measurement, "Phase");
  auto amplitude = number(measurement, "TestAmplVPP.");
  if (!amplitude) {
    amplitude = number(measurement, "TestAmplVPP");
  }
  const auto where = [&](const char* what) {
    return fmt::format("channel '{}', {} Hz: {}", settings.channel, frequency, what);
  };
  if (!frequency_hz || !gain || !phase || !amplitude) {
    return bad_file(
        settings, where("a measurement lacks Freq, Amplitude, Phase or TestAmplVPP. as a number"));
  }
  if (!(*frequency_hz > 0.0) || !(*gain > 0.0) || !(*amplitude > 0.0)) {
    return bad_file(settings, where("frequency, gain and test amplitude must be positive"));
  }
  analysis::AdcCalibrationPoint point;
  point.frequency_hz = *frequency_hz;
  point.test_amplitude_vpp = *amplitude;
  point.gain = *gain;
  point.phase_lag_rad = settings.phase_sign == PhaseSign::lag ? *phase : -*phase;
  point.u_gain = number(measurement, "u_Amplitude").value_or(0.0);
  point.u_phase_lag_rad = number(measurement, "u_Phase").value_or(0.0);
  if (!(point.u_gain >= 0.0) || !(point.u_phase_lag_rad >= 0.0)) {
    return bad_file(settings, where("a standard uncertainty is negative"));
  }
  if (point.u_gain > 0.5 * point.gain || point.u_phase_lag_rad > std::numbers::pi / 2.0) {
    return bad_file(settings, where("a standard uncertainty above half the gain or pi / 2 rad is "
                                    "not plausible; u_Phase is in rad, u_Amplitude that of the "
                                    "gain"));
  }
  return point;
}

Expected<Points> read_measurements(const Json& frequencies, const AdcCorrectionSettings& settings) {
  Points measurements;
  for (const auto& item : frequencies.items()) {
    const Json list = item.value().is_array() ? item.value() : Json::array({item.value()});
    for (const Json& measurement : list) {
      DYNCAL_TRY(const auto point, read_measurement(measurement, settings, item.key()));
      measurements.push_back(point);
    }
  }
  return measurements;
}

Expected<Points> of_one_amplitude(const Points& points, const AdcCorrectionSettings& settings) {
  std::set<double> amplitudes;
  for (const auto& point : points) {
    amplitudes.insert(point.test_amplitude_vpp);
  }
  const double wanted = settings.test_amplitude_vpp.value_or(*amplitudes.begin());
  if (!settings.test_amplitude_vpp && amplitudes.size() > 1) {
    return bad_file(
        settings,
        fmt::format(
            "channel '{}' has the test amplitudes {} Vpp: choose one with test_amplitude_vpp",
            settings.channel, fmt::join(amplitudes, ", ")));
  }
  const auto distance = [&](double amplitude) { return std::abs(std::log2(amplitude / wanted)); };
  const double nearest =
      *std::min_element(amplitudes.begin(), amplitudes.end(),
                        [&](double a, double b) { return distance(a) < distance(b); });
  if (!(distance(nearest) <= 1.0)) {
    return bad_file(settings,
                    fmt::format("channel '{}' has no test amplitude near {} Vpp (it has: {})",
                                settings.channel, wanted, fmt::join(amplitudes, ", ")));
  }
  Points chosen;
  std::copy_if(points.begin(), points.end(), std::back_inserter(chosen),
               [&](const auto& point) { return point.test_amplitude_vpp == nearest; });
  return chosen;
}

} // namespace

Expected<Points> read_adc_file(const AdcCorrectionSettings& settings) {
  std::ifstream stream(settings.file);
  if (!stream) {
    return bad_file(settings, "cannot be opened");
  }
  const Json file = Json::parse(stream, nullptr, false);
  if (file.is_discarded()) {
    return bad_file(settings, "is no JSON");
  }
  DYNCAL_TRY(const auto frequencies, frequencies_of_channel(file, settings));
  DYNCAL_TRY(const auto measurements, read_measurements(*frequencies, settings));
  if (measurements.empty()) {
    return bad_file(settings, fmt::format("has no measurement for channel '{}'", settings.channel));
  }
  return of_one_amplitude(analysis::adc_calibration_points(measurements), settings);
}

Expected<std::vector<analysis::AdcCalibrationPoint>> read_adc_calibration(const BenchFile& bench) {
  return bench.corrections.adc ? read_adc_file(*bench.corrections.adc)
                               : Expected<std::vector<analysis::AdcCalibrationPoint>>{};
}

} // namespace dyncal::inline bench
