// One of the ways to evaluate a run: what it searches, when a step is complete, and how a step
// becomes results.
//
// There is one implementation a method, and make_method() chooses it by the recipe; nothing else
// asks which method a run has. RunEvaluator does what is common to all: it takes samples, searches,
// and evaluates the steps in their order. Steps are places in that order (record/step_order.hpp).
//
// Belongs to one thread, but for the evaluation of a step: it is a value that may run in any
// thread, and looks at nothing that changes.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/contract/reference_step.hpp"
#include "services/contract/triggered_record.hpp"
#include "services/evaluation/recipe/recipe.hpp"
#include "services/evaluation/record/run_records.hpp"
#include "services/evaluation/result/clock_report.hpp"
#include "services/evaluation/result/step_result.hpp"

namespace dyncal::inline evaluation {

// Asked to stop, one ends soon, with results that nobody should state as they are: their check by
// Monte Carlo is missing.
using Evaluation = std::function<std::vector<StepResult>(const std::stop_token& stop)>;

class Method {
public:
  explicit Method(std::shared_ptr<const Recipe> recipe)
      : recipe_(std::move(recipe)), roles_(recipe_->roles) {}
  virtual ~Method() = default;
  Method(const Method&) = delete;
  Method& operator=(const Method&) = delete;

  // The channels that the steps are found in, each with the sources to which its intervals apply;
  // that of the ACS first.
  [[nodiscard]] virtual std::vector<SearchedChannel> searches() const = 0;

  // Whether sources whose stamps are compared are of one time scale, as far as they have described
  // themselves. Fails (no_source) with the sources that disagree.
  [[nodiscard]] virtual Expected<void> check_time_scales(const RunRecords& records) const;

  // A record of `source` that belongs to a step which is not evaluated yet.
  virtual void add(const std::string& source, TriggeredRecord record);

  // A step that the reference's system has evaluated itself.
  virtual void add(ReferenceStep step);

  // All that the evaluation of the step needs is there, or cannot come any more. REQUIRES: the step
  // was searched.
  [[nodiscard]] virtual bool is_complete(std::size_t step, const RunRecords& records) const;

  // REQUIRES: is_complete(step); for the steps in their order, and where can_run_ahead() perhaps
  // more than once for one of them.
  [[nodiscard]] virtual Evaluation evaluation(std::size_t step, const RunRecords& records) = 0;
  // Evaluations leave no trace here, so that a step can be evaluated while its end is only
  // expected, and once more if it comes otherwise.
  [[nodiscard]] virtual bool can_run_ahead() const { return true; }

  // At the end of a run: what all steps together tell of the results of each. Returns whether it
  // changed them.
  [[nodiscard]] virtual bool settle(std::span<StepResult> results) const;

  // The source whose stamps tell of the sensor's sample clock; empty where there are none.
  [[nodiscard]] virtual std::optional<std::string> clock_source() const { return std::nullopt; }
  // What the evaluated steps themselves tell of it.
  [[nodiscard]] virtual std::vector<ClockReport> clock_reports() const { return {}; }

protected:
  // Of a step that was not found in `sync`: results that say so.
  [[nodiscard]] Evaluation not_found(std::size_t step, const RunRecords& records,
                                     const ChannelName& sync,
                                     const std::vector<ChannelName>& dut) const;

  const std::shared_ptr<const Recipe> recipe_;
  const RoleNames& roles_;
};

// Of the recipe's method. The recipe does not change any more.
[[nodiscard]] std::unique_ptr<Method> make_method(std::shared_ptr<const Recipe> recipe);

} // namespace dyncal::inline evaluation
