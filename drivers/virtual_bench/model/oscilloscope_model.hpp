// An oscilloscope with two inputs on the virtual bench: input 1 sees the sync line, input 2 its own
// trigger output.
//
// single() arms; advance_to() searches for the trigger and, when the window has passed, records
// 8-bit codes of both inputs. 25 codes are one division, code 128 is the screen's centre; values
// outside 0..255 are clipped. Sample i lies at origin + i * interval from the trigger point. One
// thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "drivers/virtual_bench/model/excitation.hpp"
#include "drivers/virtual_bench/model/random.hpp"
#include "drivers/virtual_bench/model/trigger_model.hpp"

namespace dyncal::drivers::virtual_bench {

struct ScopeInput {
  double volts_per_division = 1.0;
  double offset_v = 0.0; // added to the signal
  bool shown = true;
};

struct ScopeSetting {
  std::array<ScopeInput, 2> inputs;
  double seconds_per_division = 1e-3;
  double centre_s = 0.0; // of the screen, from the trigger
  std::size_t points = 10'000;
  double level_v = 0.0;

  [[nodiscard]] double window_s() const { return 10.0 * seconds_per_division; }
  [[nodiscard]] double interval_s() const { return window_s() / static_cast<double>(points); }
  [[nodiscard]] double origin_s() const { return centre_s - 0.5 * window_s(); }
};

class OscilloscopeModel {
public:
  static constexpr double codes_per_division = 25.0;
  static constexpr double trigger_output_v = 3.3;

  explicit OscilloscopeModel(const TriggerSettings& settings);

  // Takes effect with the next single().
  ScopeSetting setting;

  enum class State { stopped, waiting, triggered };
  void single();
  void stop() { state_ = State::stopped; }
  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] double output_delay_s() const { return trigger_.output_delay_s(); }

  struct Record {
    ScopeSetting setting;
    std::array<std::string, 2> codes;
  };
  // Of the last complete acquisition.
  [[nodiscard]] const std::optional<Record>& record() const { return record_; }

  // The trigger that came before `time_s`, if one did; the caller hands its edge to the sensor.
  [[nodiscard]] std::optional<TriggerEvent> advance_to(double time_s, const Excitation& excitation);

private:
  void take_record(const Excitation& excitation);

  TriggerSettings settings_;
  TriggerModel trigger_;
  Random noise_;
  State state_ = State::stopped;
  ScopeSetting armed_setting_;
  double now_s_ = 0.0;
  double search_from_s_ = 0.0;
  TriggerEvent event_;
  std::optional<Record> record_;
};

} // namespace dyncal::drivers::virtual_bench
