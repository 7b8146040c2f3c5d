// The first state of a run that is resumed: it waits until the analysis attends to it, with all of
// its results so far, or says that it has ended.
//
//   a result of it names another recipe               fails: bad_file
//   it is refused                                     fails with its reason, or that nothing was
//                                                     measured, where nothing tells of any
//   it has ended                                      its results are collected
//   a source is another instrument now                fails: no_source
//   the analysis has ended it by command              fails with its reason
//   nothing comes for StepSequence::away_limit        fails: no_analysis
//   nobody answers for ArmingWait::limit              fails: no_analysis
//
// Where nothing tells yet that the analysis holds the run with this recipe, it is given
// recipe_limit to refuse another one. Belongs to the conductor's thread.
#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>

#include "services/base/error.hpp"
#include "services/run/begun_run.hpp"
#include "services/run/run_watch.hpp"

namespace dyncal::inline run {

// `name`: of the run, for people.
[[nodiscard]] Expected<void> check_same_instruments(const RunWatch& watch, const std::string& name);

class ResumeWait {
public:
  // In which the analysis hears of the recipe, every 2 s, and refuses another one.
  static constexpr std::chrono::milliseconds recipe_limit{2500};

  // `begun`: what the folder of the run tells; it outlives the object.
  ResumeWait(RunWatch& watch, std::string name, std::string bench,
             const std::optional<BegunRun>& begun)
      : watch_(watch), name_(std::move(name)), bench_(std::move(bench)), begun_(begun),
        began_(watch.clock().now()), attended_(began_), signs_before_(watch.signs_of_work()) {}

  // Fails too when it is stopped (interrupted).
  [[nodiscard]] Expected<void> wait(const std::stop_token& stop);

private:
  // Nothing while the analysis may still tell what it holds of the run.
  [[nodiscard]] std::optional<Expected<void>> answer() const;
  [[nodiscard]] Error refusal() const;
  [[nodiscard]] bool may_be_another_recipe() const;

  RunWatch& watch_;
  std::string name_;
  std::string bench_;
  const std::optional<BegunRun>& begun_;
  RunWatch::Instant began_;
  RunWatch::Instant attended_; // a sign of work was seen last
  std::size_t signs_before_;
};

} // namespace dyncal::inline run
