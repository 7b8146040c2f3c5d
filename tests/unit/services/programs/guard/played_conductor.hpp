// The messages of a conductor, with the links that it shows its guard. One thread.
#pragma once

#include <string>
#include <utility>

#include "services/run/attendance_links.hpp"

namespace dyncal::inline programs::guard_tests {

class PlayedConductor {
public:
  explicit PlayedConductor(std::string run = "r1") : run_(std::move(run)) {}

  wire::Measurement measurement(wire::MeasurementState state = wire::MEASUREMENT_RUNNING) {
    wire::Measurement message;
    message.bench("b1");
    message.run(run_);
    message.state(state);
    links_.show(message);
    return message;
  }
  wire::Excitation excitation(wire::ExcitationState state = wire::EXCITATION_STEADY) {
    wire::Excitation message;
    message.bench("b1");
    message.run(run_);
    message.state(state);
    message.frequency_text_hz("40");
    message.level_m_s2(20.0);
    message.window_end_utc_ns(state == wire::EXCITATION_DONE ? 2 : 0);
    links_.show(message);
    return message;
  }

private:
  std::string run_;
  run::AttendanceLinks links_ = run::AttendanceLinks::draw(std::chrono::hours(2)).value();
};

} // namespace dyncal::inline programs::guard_tests
