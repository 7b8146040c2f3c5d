// Whether the exciter goes on after its generator has answered that the output is off: a relay that
// sticks, an amplifier with an oscillator of its own, a channel that is not the one that answers.
// Only the reference shows it.
//
//   L    its steady level at the frequency that is driven, with its phase, the newest from before
//        the run was last heard: later ones may be of an exciter that is off
//   A    the same of samples from after the output was off, every half second
//   q    what it showed at that frequency before the run, or after a step of another frequency,
//        where there was time to listen: hum
//
// The exciter goes on where `looks` A in a row, over 1.5 s, are L within a quarter, do not fall by
// more than 3 %, and are above 2 q. Where q is not known, they have to go on with the very sine of
// L: |A e^(i a) - L| <= L / 4, a being the phase of A beyond what that of L has become at the rate
// at which it moved before. Hum that is left alone differs from L by what was excited; one such A
// says that the exciter stopped. Only hum above three times the excitation is taken for it. An
// exciter that rings falls; hum was there before, or is not L. It has stopped when the reference
// shows no such level any more.
//
// Samples are read from when a run is announced until the generator is watched no longer: call
// look() at every turn, for a reader that nobody empties holds its source up. Where none come, or
// the level does not stand out of what else the reference shows, nothing is said. Frequencies below
// 4 Hz are not listened to for hum. One thread.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/contract/channel_name.hpp"
#include "services/run/level_meter.hpp"

namespace dyncal::inline programs {

class ReferenceWatch {
public:
  using Instant = bus::Clock::Instant;
  enum class Phase {
    unwatched,
    quiet,  // a run begins, and nothing was driven so far
    driven, // or is not known to be off
    off     // after it was driven
  };

  static constexpr std::chrono::milliseconds interval{500};
  static constexpr std::size_t looks = 4;

  // `reference`: a channel of an ACS. `planned_hz`: where to listen for hum. `participant` outlives
  // the object.
  ReferenceWatch(bus::Participant& participant, std::string bench, ChannelName reference,
                 const std::vector<double>& planned_hz, std::shared_ptr<bus::WakeUp> wake_up);

  // `frequency_hz`: of what is or was driven; 0: nothing. `heard`: when the run last was.
  void look(Phase phase, double frequency_hz, Instant heard, Instant now);

  // What the reference shows of an exciter that goes on; empty: nothing speaks for it.
  [[nodiscard]] const std::string& still_driven() const { return still_driven_; }

private:
  [[nodiscard]] double kept_s(double frequency_hz) const;
  void enter(Phase phase, double frequency_hz, Instant now);
  void listen_for_hum();
  void measure(Instant heard, Instant now);
  void take_driven(const LevelReading& reading, const analysis::Frequency& frequency);
  void judge(const LevelReading& reading, const analysis::Frequency& frequency);
  [[nodiscard]] bool goes_on(const LevelReading& reading, const analysis::Frequency& frequency);

  bus::Participant& participant_;
  std::string bench_;
  ChannelName reference_;
  std::vector<std::string> planned_hz_;
  double longest_window_s_ = 0.0; // of them
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::optional<LevelMeter> meter_; // while it is watched
  Phase phase_ = Phase::unwatched;
  double frequency_hz_ = 0.0;
  Instant since_{};
  Instant next_look_{};
  bool has_listened_ = false;                // in this phase
  std::map<std::string, double> quiet_m_s2_; // by frequency
  struct Look {
    Instant at{};
    LevelReading reading;
  };
  std::optional<Look> unconfirmed_; // driven, if the run is heard after it
  std::optional<double> driven_m_s2_;
  std::optional<SineOfPart> sine_; // that of L, then of each A that goes on with it
  double rate_rad_s_ = 0.0;        // of its phase beyond that of the frequency
  bool has_stopped_ = false;       // an A was another sine
  std::vector<double> after_m_s2_; // in a row, the newest `looks`
  std::string still_driven_;
};

} // namespace dyncal::inline programs
