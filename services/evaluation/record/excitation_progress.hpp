// How far the excitation of a run has come, by what is announced and by the host times of samples.
//
// A step is over in a source when its excitation was announced as over and the source has sent
// samples from `RunRecords::grace` later, when the source has ended, or when the run is cut short.
// Belongs to one thread; the recipe must outlive it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/source_record.hpp"
#include "services/evaluation/record/step_order.hpp"

namespace dyncal::wire {
class Excitation;
}

namespace dyncal::inline evaluation {

struct StepAnnouncement {
  enum class State { excited, done, aborted };
  std::uint32_t step = 0; // as the recipe numbers it
  State state = State::excited;
  std::uint32_t attempt = 1;
  std::vector<std::uint32_t> repeated_steps{}; // so far in the run, in their order
};

[[nodiscard]] StepAnnouncement from_message(const wire::Excitation& excitation);

// Steps are places in the order of their excitation (step_order.hpp): the recipe's, then those that
// were excited again.
class ExcitationProgress {
public:
  explicit ExcitationProgress(const Recipe& recipe) : order_(recipe) {}

  // Passes over a step that the recipe does not have.
  void announce(const StepAnnouncement& announcement);
  // No excitation comes any more: the run is done, or was broken off after the steps announced so
  // far.
  void end(bool aborted);
  // Nothing comes any more from any source.
  void cut_short() { cut_short_ = true; }

  [[nodiscard]] const StepOrder& order() const { return order_; }
  // Somebody conducts the run step by step, and may excite some again until it has ended.
  [[nodiscard]] bool is_conducted() const { return is_conducted_; }
  void expect_announcements() { is_conducted_ = true; }
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] bool is_cut_short() const { return cut_short_; }
  [[nodiscard]] std::size_t steps_expected() const;
  // Steps that samples may show by now. Where somebody conducts the run, a sine of a step that was
  // not announced is somebody else's: of a conductor in another domain, or made by hand after this
  // one has died.
  [[nodiscard]] std::size_t steps_begun() const;
  [[nodiscard]] bool is_announced_over(std::size_t step) const { return over_.contains(step); }
  // The step that is excited now, by what was announced.
  [[nodiscard]] std::optional<std::size_t> excited_step() const;
  [[nodiscard]] bool is_broken_off(std::size_t step) const { return broken_off_.contains(step); }

private:
  StepOrder order_;
  std::set<std::size_t> over_;
  std::set<std::size_t> broken_off_;
  std::size_t steps_announced_ = 0;
  bool is_conducted_ = false;
  bool ended_ = false;
  bool aborted_ = false;
  bool cut_short_ = false;
};

} // namespace dyncal::inline evaluation
