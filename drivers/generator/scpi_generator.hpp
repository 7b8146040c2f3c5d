// A function generator over TCP or VXI-11 that speaks SCPI as the Rigol DG4000 series does (channel
// 1, load set to high impedance).
//
// Commands: *IDN?, :SOURce1:FUNCtion, :SOURce1:VOLTage (peak to peak), :SOURce1:FREQuency,
// :OUTPut1, each followed by :SYSTem:ERRor?; an error that the instrument reports is passed on as
// it is (refused). An answer may take 8 s (timeout), which TCP needs where a fifth of the packets
// are lost (4 s while connecting); after that the connection is given up, and the next call
// reconnects, which switches the output off.
//
// What another program may have left (left_over_state.hpp) is reset while connecting, with the
// output off, and read back: an instrument that answers that it is still there is refused, a reset
// that it refuses is passed over. The DC offset is asked again before each ON; peak voltage plus
// |offset| stays within the limit (invalid_setting).
//
// No command arrives later than 2 s after it was sent: an ON that the network held would otherwise
// switch on after the run, with nobody there. OFF is believed when :OUTPut1? confirms it: a front
// panel that is locked, another dialect or a relay leave the output on without an error (refused).
// An output that was switched on is asked at each turn of a wait whether it still is: an instrument
// that is mute or was switched off is noticed in the step (timeout, refused).
//
// The virtual bench also understands :BENCh:TIME? and :BENCh:WAIT?; with every other instrument,
// bench time is the host's monotonic clock. One thread.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "drivers/generator/generator.hpp"
#include "drivers/generator/host_clock.hpp"
#include "drivers/generator/left_over_state.hpp"
#include "drivers/link/scpi_connection.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers::generator {

class ScpiGenerator : public Generator {
public:
  // Connects, identifies the instrument, switches the output off, resets what was left and chooses
  // a sine. The limit is zero to peak.
  [[nodiscard]] static Expected<std::unique_ptr<ScpiGenerator>>
  connect(const std::string& address,
          double maximum_voltage_v = std::numeric_limits<double>::infinity());
  ~ScpiGenerator() override;
  ScpiGenerator(const ScpiGenerator&) = delete;
  ScpiGenerator& operator=(const ScpiGenerator&) = delete;

  [[nodiscard]] const std::string& identity() const override { return identity_; }
  [[nodiscard]] Expected<void> set_frequency(const std::string& decimal_hz) override;
  [[nodiscard]] Expected<void> set_amplitude_v(double amplitude_v) override;
  [[nodiscard]] Expected<void> set_output(bool on) override;
  // A rectangle in place of the sine until the next connection, to calibrate trigger delays.
  [[nodiscard]] Expected<void> set_rectangle(bool rectangle);
  // Fails as set_amplitude_v() and load_waveform() do (arbitrary_waveform.hpp), and where the
  // connection was lost on the way. An output is not switched on over another connection than that
  // of its waveform (disconnected): its amplitude would be that of a single sine.
  [[nodiscard]] Expected<void> set_waveform(std::span<const double> samples_v,
                                            double rate_hz) override;
  // Whether the instrument says that its output is on; nothing where its answer is neither.
  [[nodiscard]] Expected<std::optional<bool>> output_is_on();
  [[nodiscard]] Expected<bool> wait_for_effect(std::chrono::milliseconds) override { return true; }
  void call_while_waiting(const std::function<bool(Awaited)>& callback) override;
  [[nodiscard]] Expected<double> clock_now_s() override;
  [[nodiscard]] Expected<double> wait_until_s(double time_s, std::stop_token stop) override;

private:
  ScpiGenerator() = default;
  void choose_clock();
  bool go_on_waiting();
  Expected<void> reconnect();
  Expected<void> set_up(ScpiConnection& connection);
  Expected<void> reset(ScpiConnection& connection);
  Expected<void> check_voltage(double amplitude_v) const;
  Expected<void> check_before_on();
  Expected<void> switch_on();
  Expected<void> confirm_off();
  Expected<void> confirm_on();
  Expected<void> command(const std::string& text);
  Expected<std::string> query(const std::string& text);
  Expected<double> query_bench_time(const std::string& text);

  StopSignal never_raised_; // waits here end by their own limit
  std::string address_;
  std::optional<ScpiConnection> connection_;
  std::function<bool(Awaited)> while_waiting_;
  bool switches_off_ = false; // now: its answer is waited for even where the caller would not
  std::string identity_;
  bool has_bench_clock_ = false;
  bool reads_back_ = true; // an unknown instrument may not answer the questions
  bool answers_offset_ = false;
  double maximum_voltage_v_ = std::numeric_limits<double>::infinity();
  double amplitude_v_ = 0.0; // as set last
  double offset_v_ = 0.0;    // as read last
  bool is_on_ = false;       // as set last
  bool wants_waveform_ = false;
  bool has_waveform_ = false; // over this connection
  double asked_s_ = 0.0;      // host clock: whether it still is
  HostClock host_clock_;
};

} // namespace dyncal::drivers::generator
