// The generator of a run as its steps drive it: what of its output is known, what it says of
// itself, and waiting in bench time, which its clock tells.
//
// The output may be on from expect_output() until wait_for_effect() or switch_off() has found it
// off: then the generator or its operator has confirmed it. A guard switches it off when the
// program is killed, and goes on trying when the object is destroyed before it is known to be off.
// Fails: device (what the generator reports), and as the hooks do. A requested stop of the step
// ends every wait and is no failure. Belongs to one thread.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>

#include "drivers/generator/generator.hpp"
#include "idl/dyncal.h"
#include "services/bench/file/bench_file.hpp"
#include "services/run/generator_connection.hpp"
#include "services/run/run_environment.hpp"

namespace dyncal::inline run {

// What the run does while it waits.
struct WaitHooks {
  AskOperator ask;
  // Called while the generator lets wait for an answer.
  std::function<void()> look;
  // Called while the virtual bench lets wait for its time.
  std::function<void()> hold;
  // Called at least every second of bench time; fails when the step cannot go on.
  std::function<Expected<void>()> keep_alive;
};

// An error that names the step.
[[nodiscard]] Error of_step(const wire::PlannedStep& step, ErrorCode code, const std::string& what);

class DrivenGenerator {
public:
  // Its output is off then. `took_time`: called with the bench time, at least every second of it.
  [[nodiscard]] static Expected<std::unique_ptr<DrivenGenerator>>
  connect(const RunEnvironment& environment, const GeneratorSettings& settings, WaitHooks hooks,
          std::function<void(double now_s)> took_time);

  ~DrivenGenerator();
  DrivenGenerator(const DrivenGenerator&) = delete;
  DrivenGenerator& operator=(const DrivenGenerator&) = delete;

  // What fails from now on is of this step, and what waits ends with its stop.
  void begin(const wire::PlannedStep& step, const std::stop_token& stop);

  [[nodiscard]] drivers::generator::Generator& instrument() { return *connection_.generator; }
  void expect_output() { output_may_be_on_ = true; }
  [[nodiscard]] bool output_may_be_on() const { return output_may_be_on_; }
  // It did not answer in the last step, or not as it should: a link that is down, an instrument
  // that was switched off. Never of one that is set by hand.
  [[nodiscard]] bool is_away() const { return is_away_; }
  // What failed in the last step was a matter of that step. Never so of one that is set by hand.
  [[nodiscard]] bool fault_may_pass() const { return fault_may_pass_; }

  // What it reports; notes whether it is away, or has a fault that may pass.
  Error reported(const drivers::Error& error);
  // Another attempt may be without it.
  Error fault_of_step(const std::string& what);

  // Bench time.
  [[nodiscard]] Expected<double> now_s();
  // Returns false if a stop was requested.
  [[nodiscard]] Expected<bool> hold_until(double bench_time_s);
  // Until what was set is in effect. Returns false if a stop was requested.
  [[nodiscard]] Expected<bool> wait_for_effect();
  // Connects anew where the connection is lost. Returns whether the output is known to be off: one
  // that is set by hand, not before the operator has confirmed.
  [[nodiscard]] Expected<bool> switch_off();
  // The same, once the operator has confirmed it, or a stop was requested.
  [[nodiscard]] Expected<void> wait_until_off();

private:
  DrivenGenerator(const GeneratorSettings& settings, GeneratorConnection connection,
                  WaitHooks hooks, std::function<void(double now_s)> took_time)
      : is_instrument_(is_instrument(settings.driver)), connection_(std::move(connection)),
        hooks_(std::move(hooks)), took_time_(std::move(took_time)) {}

  bool is_instrument_;
  GeneratorConnection connection_;
  WaitHooks hooks_;
  std::function<void(double now_s)> took_time_;
  bool output_may_be_on_ = false;
  bool is_away_ = false;
  bool fault_may_pass_ = false;
  wire::PlannedStep step_; // that is, or was last, excited
  std::stop_token stop_;   // likewise
};

} // namespace dyncal::inline run
