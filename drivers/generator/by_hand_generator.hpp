// A generator that a person sets: asks for each setting, and takes a line (Enter) as confirmation.
//
// set_frequency() and set_amplitude_v() are remembered. set_output(true) asks for all of it in the
// order of the work (values first, output last), set_output(false) asks to switch the output off,
// and a new amplitude while the output is on asks for that alone. Only wait_for_effect() waits for
// the person, so that the caller can do other things meanwhile. The output counts as on until the
// person has confirmed that it is off; set_output(false) asks for that once.
//
// Confirmations are lines of a descriptor, a terminal or not; on a terminal, what was typed before
// the question does not count, elsewhere every question takes a line. Bench time is the host's.
// Destruction asks to switch the output off when it is, or may be, on and nobody has asked yet.
//
// Fails: disconnected (the descriptor has ended). One thread.
#pragma once

#include <functional>
#include <string>

#include "drivers/generator/generator.hpp"
#include "drivers/generator/host_clock.hpp"

namespace dyncal::drivers::generator {

class ByHandGenerator : public Generator {
public:
  using Show =
      std::function<void(const std::string&)>; // one request to the person, without line end

  // Reads confirmations from `input`, which stays open and stays the caller's.
  ByHandGenerator(int input, Show show) : input_(input), show_(std::move(show)) {}
  ~ByHandGenerator() override;
  ByHandGenerator(const ByHandGenerator&) = delete;
  ByHandGenerator& operator=(const ByHandGenerator&) = delete;

  [[nodiscard]] const std::string& identity() const override { return identity_; }
  [[nodiscard]] Expected<void> set_frequency(const std::string& decimal_hz) override;
  [[nodiscard]] Expected<void> set_amplitude_v(double amplitude_v) override;
  [[nodiscard]] Expected<void> set_output(bool on) override;
  [[nodiscard]] Expected<bool> wait_for_effect(std::chrono::milliseconds limit) override;
  [[nodiscard]] Expected<double> clock_now_s() override { return clock_.now_s(); }
  [[nodiscard]] Expected<double> wait_until_s(double time_s, std::stop_token stop) override {
    return clock_.wait_until_s(time_s, stop);
  }

private:
  void ask(const std::string& what);

  int input_;
  Show show_;
  HostClock clock_;
  std::string identity_ = "set by hand";
  std::string frequency_hz_;
  double amplitude_v_ = 0.0;
  bool on_ = false;            // or may be
  bool switching_off_ = false; // asked for, and not confirmed yet
  int unanswered_ = 0;         // questions
};

} // namespace dyncal::drivers::generator
