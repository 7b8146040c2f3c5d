// What a run attends to as long as it lasts, whatever it does meanwhile: it repeats its Measurement
// and what is excited now, so that everybody knows that it lives, takes what the analysis publishes
// and what others command, and shows how far it is.
//
// Whoever waits for anything calls look() at least every half second. Belongs to one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "services/evaluation/result/run_outcome.hpp"
#include "services/run/run_commands.hpp"
#include "services/run/run_messages.hpp"
#include "services/run/run_outlook.hpp"
#include "services/run/run_progress.hpp"

namespace dyncal::inline run {

class RunWatch {
public:
  using Instant = bus::Clock::Instant;

  // `generator`: the address that the run drives, empty where it drives none that could be
  // switched off over the network. `outcome` and `clock` outlive the object. Fails (network) as
  // writers and readers do.
  [[nodiscard]] static Expected<std::unique_ptr<RunWatch>>
  open(bus::Participant& participant, bus::Clock& clock, wire::Measurement measurement,
       std::string generator, const std::shared_ptr<bus::WakeUp>& wake_up, RunOutcome& outcome,
       ShowProgress show);

  [[nodiscard]] const wire::Measurement& measurement() const { return measurement_; }
  void set_state(wire::MeasurementState state, const std::string& message = "");
  void announce(const wire::PlannedStep& step, std::uint32_t attempt, wire::ExcitationState state,
                bool output_may_be_on = false) {
    messages_.announce(step, attempt, state, output_may_be_on);
  }
  void confirm_off() { messages_.confirm_off(); }
  void wait_for_acknowledgments(std::chrono::nanoseconds limit) {
    messages_.wait_for_acknowledgments(limit);
  }

  // Called by look() and follow() when results have come; must not wait.
  void on_new_results(std::function<void(const RunOutcome&)> take) {
    new_results_ = std::move(take);
  }

  // What the analysis has published comes once more, for some of it may have been missed.
  void collect_again() { messages_.collect_again(); }

  // Takes what has come, and repeats the Measurement when it is due.
  void look();
  // The same while the generator lets wait for an answer: nobody has hold of it then, and its guard
  // must not hear that somebody does.
  void look_without_hold();
  // As look(), after a short wait for messages; shows `phase`.
  void follow(const std::string& phase);

  [[nodiscard]] const std::optional<wire::ServiceStatus>& analysis() const {
    return messages_.analysis();
  }
  [[nodiscard]] const std::string& analysis_participant() const {
    return messages_.analysis_participant();
  }
  [[nodiscard]] Instant analysis_heard() const { return messages_.analysis_heard(); }
  [[nodiscard]] std::size_t signs_of_work() const { return messages_.signs_of_work(); }
  [[nodiscard]] std::size_t described() const { return messages_.described(); }
  [[nodiscard]] std::string other_instrument() const { return messages_.other_instrument(); }
  // Where a result of this run names another bench file.
  [[nodiscard]] std::optional<Error> other_recipe() const;
  [[nodiscard]] RunOutlook outlook() const;
  // For people, while it is silent. REQUIRES: analysis().
  [[nodiscard]] std::string silence_of_analysis(std::chrono::seconds limit) const;
  [[nodiscard]] RunCommands& commands() { return commands_; }
  [[nodiscard]] const RunOutcome& outcome() const { return outcome_; }
  [[nodiscard]] RunOutcome& outcome() { return outcome_; }
  [[nodiscard]] bus::Clock& clock() { return clock_; }

  // From now on this step is shown; `place` from 1, in the plan.
  void show_step(std::size_t place, std::uint32_t attempt);
  void show(const std::string& phase) { show(phase, "", ""); }
  void ask(const std::string& request) { show("asking", request, ""); }
  void notice(const std::string& sentence) { show("", "", sentence); }

private:
  RunWatch(bus::Clock& clock, wire::Measurement measurement, std::shared_ptr<bus::WakeUp> wake_up,
           RunOutcome& outcome, ShowProgress show, RunMessages messages, RunCommands commands);
  void show(const std::string& phase, const std::string& request, const std::string& notice);
  [[nodiscard]] std::optional<double> seconds_left() const;

  bus::Clock& clock_;
  wire::Measurement measurement_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  RunOutcome& outcome_;
  ShowProgress show_progress_;
  std::function<void(const RunOutcome&)> new_results_;
  RunMessages messages_;
  RunCommands commands_;
  Instant measurement_published_;
  std::size_t place_ = 0;
  std::uint32_t attempt_ = 1;
  Instant first_step_began_;
  bool unplanned_said_ = false;
  bool others_said_ = false;
};

} // namespace dyncal::inline run
