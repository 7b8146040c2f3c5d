#include "drivers/generator/arbitrary_waveform.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/link/scpi_answer.hpp"

namespace dyncal::drivers::generator {
namespace {

constexpr std::size_t packet_points = 16384;
constexpr std::size_t min_points = 8;
constexpr std::size_t max_points = 8'000'000;
constexpr double half_range = 8191.5; // 14 bits: 0 to 3FFF

// The virtual bench that speaks as a Keysight names that one first.
bool takes_waveforms(std::string_view identity) {
  const std::size_t model = identity.find(",DG");
  if (model == std::string_view::npos) {
    return identity.starts_with("dyncal virtual bench");
  }
  const std::string_view number = identity.substr(model + 3, 5); // "812", "1032Z"
  return number.starts_with('8') || number.starts_with('9') ||
         (number.starts_with("10") && number.ends_with('Z'));
}

Expected<double> peak_of(std::span<const double> samples_v) {
  double peak_v = 0.0;
  for (const double value : samples_v) {
    if (!std::isfinite(value)) {
      return fail(ErrorCode::invalid_setting, "generator: a waveform holds a value that is none");
    }
    peak_v = std::max(peak_v, std::abs(value));
  }
  if (!(peak_v > 0.0)) {
    return fail(ErrorCode::invalid_setting, "generator: a waveform is 0 throughout");
  }
  return peak_v;
}

WaveformCommand packet(std::span<const double> samples_v, double peak_v, bool is_last) {
  WaveformCommand command;
  command.text = std::string(":SOURce1:TRACe:DATA:DAC16 VOLATILE,") + (is_last ? "END" : "CON");
  const std::string bytes = std::to_string(2 * samples_v.size());
  command.block = ",#5" + std::string(5 - bytes.size(), '0') + bytes;
  for (const double value : samples_v) {
    const auto code = static_cast<unsigned>(std::lround(half_range * (1.0 + value / peak_v)));
    command.block += static_cast<char>(code & 0xFFU);
    command.block += static_cast<char>(code >> 8U);
  }
  return command;
}

} // namespace

Expected<LoadedWaveform> load_waveform(std::string_view identity, std::span<const double> samples_v,
                                       double rate_hz) {
  if (!takes_waveforms(identity)) {
    return fail(ErrorCode::refused, "generator '" + shown(identity) +
                                        "' is of a family whose way to load a waveform is not "
                                        "known; a Rigol DG800, DG900 or DG1000Z can");
  }
  if (samples_v.size() < min_points || samples_v.size() > max_points || !(rate_hz > 0.0)) {
    return fail(ErrorCode::invalid_setting,
                "generator: a waveform has 8 to 8000000 points and a rate above 0");
  }
  DYNCAL_TRY(const double peak_v, peak_of(samples_v));
  LoadedWaveform loaded{peak_v, {}};
  for (std::size_t first = 0; first < samples_v.size(); first += packet_points) {
    const std::size_t count = std::min(packet_points, samples_v.size() - first);
    loaded.commands.push_back(
        packet(samples_v.subspan(first, count), peak_v, first + count == samples_v.size()));
  }
  loaded.commands.push_back({":SOURce1:FUNCtion:ARB:MODE SRATE", {}});
  loaded.commands.push_back({":SOURce1:FUNCtion:ARB:SRATe " + scpi_decimal(rate_hz), {}});
  loaded.commands.push_back({":SOURce1:FUNCtion ARB", {}});
  return loaded;
}

} // namespace dyncal::drivers::generator
