#include "drivers/virtual_bench/model/oscilloscope_model.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double output_noise_v = 0.015;
constexpr double output_rise_s = 6e-9; // of the trigger output, as the input's bandwidth shows it
constexpr double output_high_s = 50e-6;
constexpr double axis_jitter_s = 0.1e-9; // of the trigger point on the time axis

double trigger_output_at(double from_edge_s) {
  const double rise = std::clamp(from_edge_s / output_rise_s + 0.5, 0.0, 1.0);
  return from_edge_s > output_high_s ? 0.0 : OscilloscopeModel::trigger_output_v * rise;
}

char code_of(double volts, const ScopeInput& input) {
  const double code = std::rint((volts + input.offset_v) / input.volts_per_division *
                                    OscilloscopeModel::codes_per_division +
                                128.0);
  return static_cast<char>(static_cast<unsigned char>(std::clamp(code, 0.0, 255.0)));
}

} // namespace

OscilloscopeModel::OscilloscopeModel(const TriggerSettings& settings)
    : settings_(settings), trigger_(settings), noise_(settings.seed, "DSO traces") {}

void OscilloscopeModel::single() {
  state_ = State::waiting;
  armed_setting_ = setting;
  search_from_s_ =
      now_s_ +
      std::max(0.0, -armed_setting_.origin_s()); // the part before the trigger is filled first
}

std::optional<TriggerEvent> OscilloscopeModel::advance_to(double time_s,
                                                          const Excitation& excitation) {
  std::optional<TriggerEvent> fresh;
  if (state_ == State::waiting && time_s > search_from_s_) {
    const Motion motion = excitation.motion(search_from_s_);
    if (!excitation.drive().on || !motion.sync_on ||
        motion.frequency_hz != excitation.drive().frequency_hz) {
      search_from_s_ = time_s;
    } else if ((fresh = trigger_.first_between(search_from_s_, time_s, armed_setting_.level_v,
                                               excitation))) {
      event_ = *fresh;
      state_ = State::triggered;
    }
  }
  now_s_ = time_s;
  if (state_ == State::triggered &&
      time_s >= event_.trigger_s + armed_setting_.origin_s() + armed_setting_.window_s()) {
    take_record(excitation);
    state_ = State::stopped;
  }
  return fresh;
}

void OscilloscopeModel::take_record(const Excitation& excitation) {
  Record record{armed_setting_, {}};
  const ScopeSetting& set = record.setting;
  const double shift_s = noise_.normal(axis_jitter_s);
  for (std::string& codes : record.codes) {
    codes.reserve(set.points);
  }
  for (std::size_t i = 0; i < set.points; ++i) {
    const double from_trigger_s =
        set.origin_s() + static_cast<double>(i) * set.interval_s() + shift_s;
    // A difference to the trigger first: bench time does not resolve a nanosecond's parts for long.
    const double from_edge_s = from_trigger_s - (event_.output_edge_s - event_.trigger_s);
    const double sync_v =
        sync_line_v(excitation, settings_.sync_amplitude_v, event_.trigger_s + from_trigger_s);
    record.codes[0].push_back(code_of(sync_v + noise_.normal(settings_.noise_v), set.inputs[0]));
    record.codes[1].push_back(
        code_of(trigger_output_at(from_edge_s) + noise_.normal(output_noise_v), set.inputs[1]));
  }
  record_ = std::move(record);
}

} // namespace dyncal::drivers::virtual_bench
