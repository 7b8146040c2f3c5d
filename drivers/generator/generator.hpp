// The generator that excites the bench, and the bench's own clock.
//
// Voltage is the amplitude (zero to peak) of the sine in volt; frequency is decimal text in hertz,
// passed on digit by digit. After each setting the instrument is asked whether it accepted it; its
// error is passed on as the instrument gives it (refused).
//
// Bench time measures the durations of steps: the host's monotonic clock for a real bench, the
// virtual bench's own time otherwise, so that a run holds its durations however fast the virtual
// bench goes.
//
// An instrument behind a bad link may let wait for seconds before a call returns; what is given to
// call_while_waiting() is called about twice a second meanwhile, by drivers that can: with `answer`
// while the instrument answers nothing, which is a sign that nobody has hold of the output, with
// `bench_time` when it has answered and its time has not come yet. It returns false when nobody
// needs the answer any more: the call fails (timeout), and nobody knows what the instrument did.
// What switches the output off waits on.
//
// Destruction switches the output off, or asks for it where only a person can. One thread.
#pragma once

#include <chrono>
#include <functional>
#include <span>
#include <stop_token>
#include <string>

#include "drivers/error.hpp"

namespace dyncal::drivers::generator {

enum class Awaited { answer, bench_time };

class Generator {
public:
  virtual ~Generator() = default;
  // Manufacturer, model, serial number and firmware as the instrument reports them.
  [[nodiscard]] virtual const std::string& identity() const = 0;
  [[nodiscard]] virtual Expected<void> set_frequency(const std::string& decimal_hz) = 0;
  [[nodiscard]] virtual Expected<void> set_amplitude_v(double amplitude_v) = 0;
  // One period of a waveform in place of the sine, to repeat, until the next connection; the peak
  // of its samples is the amplitude. Fails (refused) where the generator cannot. REQUIRES: the
  // output is off.
  [[nodiscard]] virtual Expected<void> set_waveform(std::span<const double> /*samples_v*/,
                                                    double /*rate_hz*/) {
    return fail(ErrorCode::refused, identity() + ": takes no waveform");
  }
  // The output is known to be off when set_output(false) is in effect, see wait_for_effect().
  [[nodiscard]] virtual Expected<void> set_output(bool on) = 0;
  // Returns true once everything that was set is in effect: with an instrument when the call that
  // set it returns, otherwise when the operator has confirmed; waits up to `limit` for that.
  [[nodiscard]] virtual Expected<bool> wait_for_effect(std::chrono::milliseconds limit) = 0;
  [[nodiscard]] virtual Expected<double> clock_now_s() = 0;
  virtual void call_while_waiting(const std::function<bool(Awaited)>& /*callback*/) {}
  // Returns the bench time when it has reached `time_s`, or earlier when a stop is requested.
  [[nodiscard]] virtual Expected<double> wait_until_s(double time_s, std::stop_token stop) = 0;
};

} // namespace dyncal::drivers::generator
