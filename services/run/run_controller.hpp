// Conducts one run on a bench: publishes the recipe, waits until the analysis is armed, excites
// step by step, collects what is published.
//
// Order of messages: idl/README.md, "The run protocol"; services/run/step_excitation.hpp excites
// the steps. The generator's output is off on every way out: end, error, stop.
//
// Fails: no_analysis (nobody answers, or the run is not armed in time), no_source (the analysis
// refuses the run), device (generator), network, interrupted (before the first step). Later there
// are no failures: the outcome holds what was measured and gives the reason why the run ended
// early. Belongs to one thread.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "analysis/instrument/adc_calibration.hpp"
#include "services/bench/bench_file.hpp"
#include "services/evaluation/result/run_outcome.hpp"
#include "services/run/run_messages.hpp"
#include "services/run/step_excitation.hpp"

namespace dyncal::services {

struct RunProgress {
  std::size_t step = 0; // 1..steps; 0 before the first
  std::size_t steps = 0;
  std::string frequency_hz;
  std::string phase;   // "waiting for the analysis", "settling", "measuring", ...
  std::string request; // to the operator; "" for none
  std::size_t results = 0;
  std::optional<double> seconds_left; // of the host's clock
};

class RunController {
public:
  using ShowProgress = std::function<void(const RunProgress&)>;

  static constexpr std::chrono::seconds answer_limit{4};    // for an analysis service to answer
  static constexpr std::chrono::seconds armed_limit{14};    // until it has armed or refused the run
  static constexpr std::chrono::seconds analysis_limit{10}; // between two of its messages
  static constexpr std::chrono::seconds results_limit{25};  // from the last result to the next

  RunController(bus::Participant& participant, const BenchFile& bench, std::string run,
                ShowProgress show_progress)
      : RunController(RunEnvironment{.participant = participant}, bench, std::move(run),
                      std::move(show_progress)) {}
  RunController(RunEnvironment environment, const BenchFile& bench, std::string run,
                ShowProgress show_progress);

  [[nodiscard]] Expected<RunOutcome>
  conduct(const std::vector<analysis::AdcCalibrationPoint>& adc_calibration,
          const std::stop_token& stop);

private:
  using Instant = bus::Clock::Instant;

  Expected<void> open_messages();
  Expected<void> open_excitation();
  Expected<void> wait_until_armed(const std::stop_token& stop);
  // Nothing while the analysis may still answer.
  [[nodiscard]] std::optional<Expected<void>> answer_of_analysis(Instant began) const;
  Expected<void> excite(const std::stop_token& stop);
  Expected<void> wait_for_results(const std::stop_token& stop);
  // Waits for messages, for a short while; shows `phase`.
  void follow(const std::string& phase);
  Expected<void> watch_analysis();
  [[nodiscard]] Expected<void> analysis_is_alive() const;
  [[nodiscard]] bool everything_has_come() const;
  [[nodiscard]] wire::MeasurementState final_state(bool excited) const;
  void set_state(wire::MeasurementState state);
  void repeat_measurement();
  void show(const std::string& phase, const std::string& request = "");
  void sort_outcome();

  RunEnvironment environment_;
  bus::Clock& clock_;
  const BenchFile& bench_;
  std::string run_;
  ShowProgress show_progress_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  std::optional<RunMessages> messages_;
  wire::Measurement measurement_;
  RunOutcome outcome_;
  Instant measurement_published_;
  std::size_t step_ = 0;
  Instant first_step_began_;
  // Nothing when recorded files take its place. Last: its end may ask the operator to switch the
  // output off.
  std::unique_ptr<StepExcitation> excitation_;
};

} // namespace dyncal::services
