#include <cmath>

#include <fmt/core.h>

#include "services/checks/bench_check/checks.hpp"
#include "services/run/multisine_drive.hpp"
#include "services/run/run_plan.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

constexpr double between_steps_s = 2.0; // changing the generator, evaluating the last step

std::string time_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 120) {
    return fmt::format("{} s", whole);
  }
  return whole < 7200 ? fmt::format("{} min", (whole + 59) / 60)
                      : fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

void report_multisine(const BenchView& view, const Recipe& recipe, double seconds,
                      Findings& findings) {
  findings.push_back(
      view.at(Severity::note, {"excitation"},
              fmt::format("has {} multi-sines of {} lines, about {}", recipe.excitations(),
                          recipe.lines_at_once(), time_text(seconds))));
  if (view.bench.generator.driver == GeneratorDriver::none) {
    return;
  }
  const MultisineDrive drive(view.bench);
  if (const auto checked = drive.check(); !checked) {
    findings.push_back(view.at(Severity::error, {"excitation", "level"}, checked.error().message));
  } else {
    findings.push_back(view.at(Severity::note, {"excitation", "level"},
                               fmt::format("is of each line; the peak of all together is {:.3g} "
                                           "m/s^2, {:.3g} V of the generator",
                                           drive.peak_m_s2(), drive.peak_v())));
  }
}

void report_plan(const BenchView& view, const Recipe& recipe, Findings& findings) {
  const ExcitationSettings& excitation = view.bench.excitation;
  if (excitation.whole_record) {
    findings.push_back(view.at(Severity::note, {"excitation", "window"},
                               "takes each record as a whole: one step"));
    return;
  }
  double seconds = 0.0;
  for (const RecipeStep& step : recipe.steps) {
    seconds += step.settling_s + step.duration_s + between_steps_s;
  }
  if (recipe.is_multisine()) {
    report_multisine(view, recipe, seconds / static_cast<double>(recipe.lines_at_once()), findings);
    return;
  }
  findings.push_back(view.at(
      Severity::note, {"excitation"},
      fmt::format("has {} steps ({} frequencies, {} repetition{}), about {}", recipe.steps.size(),
                  excitation.frequencies_hz.size(), excitation.repetitions,
                  excitation.repetitions == 1 ? "" : "s", time_text(seconds))));
}

} // namespace

Findings check_plan(const BenchView& view) {
  Findings findings;
  if (!view.problems.empty() || !check_corrections(view).empty()) {
    return findings; // the plan would be made of values that are refused already
  }
  const auto recipe = plan_recipe(view.bench, "check", view.adc);
  if (!recipe) {
    findings.push_back(
        view.at(Severity::error, {"excitation"}, "cannot be evaluated: " + recipe.error().message));
    return findings;
  }
  report_plan(view, *recipe, findings);
  return findings;
}

} // namespace dyncal::inline checks::bench_check
