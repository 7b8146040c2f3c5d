#include "services/evaluation/outcome_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "services/evaluation/transfer_summary.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double agreement_u = 0.01;     // far above rounding, far below what anybody relies on
constexpr double agreement_u_rel = 0.01; // of u itself

double larger(double a, double b) {
  return std::max(std::abs(a), std::abs(b));
}

// In the larger u; infinite where a number is not one.
double distance_u(double difference, double u, double other_u) {
  const double distance = difference == 0.0 ? 0.0 : std::abs(difference) / larger(u, other_u);
  return std::isnan(distance) ? HUGE_VAL : distance;
}

double phase_difference(double a, double b) {
  return std::remainder(a - b, 2.0 * std::numbers::pi);
}

bool is_same_u(double u, double other) {
  return (std::isnan(u) && std::isnan(other)) ||
         std::abs(u - other) <= agreement_u_rel * larger(u, other);
}

struct KnownNumber {
  double value = 0.0;
  double u = 0.0;
};

// Of a magnitude, a phase or a delay; empty: it agrees.
std::string number_difference(const char* name, const KnownNumber& published,
                              const KnownNumber& again, double difference, bool with_u) {
  if (std::isnan(published.value) && std::isnan(again.value)) {
    return "";
  }
  if (const double far = distance_u(difference, published.u, again.u); far > agreement_u) {
    return fmt::format("{} {:.6g}, not {:.6g} ({:.2g} u)", name, published.value, again.value, far);
  }
  return !with_u || is_same_u(published.u, again.u)
             ? ""
             : fmt::format("u of {} {:.3g}, not {:.3g}", name, published.u, again.u);
}

std::string value_difference(const StepResult& published, const StepResult& again, bool with_u) {
  std::string difference = number_difference("|H|", {published.magnitude, published.u_magnitude},
                                             {again.magnitude, again.u_magnitude},
                                             published.magnitude - again.magnitude, with_u);
  if (difference.empty()) {
    difference = number_difference("phase", {published.phase_rad, published.u_phase_rad},
                                   {again.phase_rad, again.u_phase_rad},
                                   phase_difference(published.phase_rad, again.phase_rad), with_u);
  }
  return difference.empty() ? ""
                            : fmt::format("{} at {} Hz (step {}): {}", published.channel,
                                          published.frequency_text_hz, published.step, difference);
}

// Where the beginning of an excitation did not come, later samples are evaluated in its place.
bool lacks_samples(const SourceSamples& again, const SourceSamples& published) {
  return again.used < published.used || again.first_stamp_ns > published.first_stamp_ns ||
         again.last_stamp_ns < published.last_stamp_ns;
}

bool has_fewer_samples(const StepResult& again, const StepResult& published) {
  return std::any_of(again.samples.begin(), again.samples.end(), [&](const SourceSamples& source) {
    return std::any_of(published.samples.begin(), published.samples.end(),
                       [&](const SourceSamples& one) {
                         return one.source == source.source && lacks_samples(source, one);
                       });
  });
}

const StepResult* find_same(const std::vector<StepResult>& results, const StepResult& wanted) {
  const auto found = std::find_if(results.begin(), results.end(),
                                  [&](const StepResult& one) { return gives_again(one, wanted); });
  return found == results.end() ? nullptr : &*found;
}

std::string point_difference(const FrequencyPoint& published, const FrequencyPoint& again) {
  const auto& a = published.mean;
  const auto& b = again.mean;
  std::string difference =
      number_difference("mean |H|", {a.magnitude, a.u_magnitude}, {b.magnitude, b.u_magnitude},
                        a.magnitude - b.magnitude, true);
  if (difference.empty()) {
    difference =
        number_difference("mean phase", {a.phase_rad, a.u_phase_rad}, {b.phase_rad, b.u_phase_rad},
                          phase_difference(a.phase_rad, b.phase_rad), true);
  }
  return difference;
}

std::string delay_difference(const TransferFunction& published, const TransferFunction& again) {
  if (published.group_delay.has_value() != again.group_delay.has_value()) {
    return "one has no group delay";
  }
  if (!published.group_delay) {
    return "";
  }
  const auto& a = *published.group_delay;
  const auto& b = *again.group_delay;
  return number_difference("group delay", {a.delay_s, a.u_delay_s()}, {b.delay_s, b.u_delay_s()},
                           a.delay_s - b.delay_s, true);
}

std::vector<TransferFunction> means_of_results(const RunOutcome& outcome) {
  TransferSummary summary(*outcome.recipe);
  for (const StepResult& result : outcome.results) {
    summary.add(result);
  }
  return summary.transfer_functions();
}

} // namespace

bool gives_again(const StepResult& again, const StepResult& published) {
  const bool is_same = again.channel == published.channel && again.step == published.step &&
                       again.repetition == published.repetition &&
                       again.attempt == published.attempt;
  return is_same && again.valid && again.lost <= published.lost &&
         !has_fewer_samples(again, published);
}

std::string mean_difference(const TransferFunction& published, const TransferFunction& again) {
  if (published.points.size() != again.points.size()) {
    return fmt::format("{}: {} frequencies, not {}", published.channel, published.points.size(),
                       again.points.size());
  }
  for (std::size_t i = 0; i < published.points.size(); ++i) {
    const FrequencyPoint& point = published.points[i];
    const bool is_same_place = point.frequency_hz == again.points[i].frequency_hz &&
                               point.level_m_s2 == again.points[i].level_m_s2;
    const std::string difference =
        is_same_place ? point_difference(point, again.points[i]) : "another frequency or level";
    if (!difference.empty()) {
      return fmt::format("{} at {} Hz: {}", published.channel, point.frequency_text_hz, difference);
    }
  }
  const std::string delay = delay_difference(published, again);
  return delay.empty() ? "" : fmt::format("{}: {}", published.channel, delay);
}

std::vector<std::string> replace_foreign_means(RunOutcome& outcome) {
  const std::vector<TransferFunction> means = means_of_results(outcome);
  std::vector<std::string> differences;
  std::erase_if(outcome.transfer_functions, [&](TransferFunction& published) {
    const auto own = std::find_if(means.begin(), means.end(), [&](const TransferFunction& one) {
      return one.channel == published.channel;
    });
    if (own == means.end()) {
      differences.push_back(published.channel + " has no valid points");
      return true;
    }
    if (std::string difference = mean_difference(published, *own); !difference.empty()) {
      differences.push_back(std::move(difference));
      published = *own;
    }
    return false;
  });
  return differences;
}

void take_means_of_results(RunOutcome& outcome) {
  std::vector<TransferFunction> means = means_of_results(outcome);
  for (TransferFunction& mean : means) {
    const auto published =
        std::ranges::find(outcome.transfer_functions, mean.channel, &TransferFunction::channel);
    if (published != outcome.transfer_functions.end() &&
        mean_difference(*published, mean).empty()) {
      mean = std::move(*published); // with its closures
    }
  }
  outcome.transfer_functions = std::move(means);
}

OutcomeAgreement hold_against(const RunOutcome& published, const RunOutcome& again) {
  OutcomeAgreement agreement;
  for (const StepResult& result : published.results) {
    agreement.values += result.valid ? 1 : 0;
    agreement.missing += result.valid && find_same(again.results, result) == nullptr ? 1 : 0;
  }
  const auto differs = [&](std::string sentence) {
    if (agreement.difference.empty()) {
      agreement.difference = std::move(sentence);
    }
  };
  for (const StepResult& result : published.results) {
    const StepResult* same = result.valid ? find_same(again.results, result) : nullptr;
    // What all steps show goes into each u: it is the same only where all are there.
    std::string difference =
        same == nullptr ? "" : value_difference(result, *same, agreement.missing == 0);
    if (!difference.empty()) {
      ++agreement.differing;
      differs(std::move(difference));
    }
  }
  for (const TransferFunction& function : published.transfer_functions) {
    const auto same =
        std::find_if(again.transfer_functions.begin(), again.transfer_functions.end(),
                     [&](const TransferFunction& one) { return one.channel == function.channel; });
    if (agreement.missing == 0 && agreement.differing == 0) {
      std::string difference = same == again.transfer_functions.end()
                                   ? function.channel + " has no mean"
                                   : mean_difference(function, *same);
      differs(std::move(difference));
    }
  }
  return agreement;
}

} // namespace dyncal::inline evaluation
