// The first state of a run: it is announced, and waits until the analysis has armed it.
//
//   nobody has answered for answer_limit                                   fails: no_analysis
//   it answers, but has not armed for limit                                fails: no_analysis
//   it refuses                                                             fails: no_source
//   it has gone silent: it or another is waited for up to away_limit, and the limits begin again
//
// Belongs to the conductor's thread; services/run/README.md has the table of all states.
#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>

#include "services/base/error.hpp"
#include "services/run/run_watch.hpp"

namespace dyncal::inline run {

class ArmingWait {
public:
  static constexpr std::chrono::seconds answer_limit{12};
  static constexpr std::chrono::seconds limit{36};

  ArmingWait(RunWatch& watch, std::string bench)
      : watch_(watch), bench_(std::move(bench)), attended_(watch.clock().now()) {}

  // Fails too when it is stopped (interrupted).
  [[nodiscard]] Expected<void> wait(const std::stop_token& stop);

private:
  // Nothing while the analysis may still answer.
  [[nodiscard]] std::optional<Expected<void>> answer() const;

  RunWatch& watch_;
  std::string bench_;
  RunWatch::Instant attended_; // since when it waits for an answer
};

} // namespace dyncal::inline run
