#include "services/evaluation/record/step_places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/base/statistics.hpp"
#include "services/evaluation/record/excitation_pairs.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double worth_of_a_pair = 1e6; // more than all costs of a plan together
constexpr double worth_of_one = 1e3;
constexpr double level_weight = 10.0; // a level 10 % off is as bad as a step that is missing
constexpr double clock_rel = 1e-4;    // a quartz
constexpr double order_weight = 1e-6; // decides where nothing else does
// Of an excitation before or between the steps that has no place: the first ones are planned.
constexpr double cost_of_left_out = 0.3;
constexpr double max_cost = 1.0; // of frequency or time
// So many excitations in a row find no place in the plan at the most.
constexpr std::size_t max_left_out = 8;

struct Choice {
  double worth = -std::numeric_limits<double>::infinity();
  std::optional<std::size_t> before{}; // excitation; its step is in `step_before`
  std::size_t step_before = 0;
};

class Places {
public:
  Places(std::span<const RecipeStep* const> plan, std::span<const ExcitationInRun> excitations,
         bool begins_late)
      : plan_(plan), excitations_(excitations), order_(begins_late ? order_weight : -order_weight),
        begins_s_(plan.size() + 1), rate_rel_(common_rate()), overhead_s_(usual_overhead_s()),
        choices_(excitations.size() * plan.size()) {
    for (std::size_t step = 0; step < plan_.size(); ++step) {
      begins_s_[step + 1] = begins_s_[step] + excited_s(step) + overhead_s_;
    }
  }

  [[nodiscard]] std::vector<std::optional<std::size_t>> best();

private:
  [[nodiscard]] double excited_s(std::size_t step) const {
    return plan_[step]->settling_s + plan_[step]->duration_s;
  }
  [[nodiscard]] std::optional<std::size_t> first_like(const FoundExcitation& found) const;
  [[nodiscard]] double common_rate() const;
  [[nodiscard]] double usual_overhead_s() const;
  [[nodiscard]] double worth(std::size_t excitation, std::size_t step) const;
  [[nodiscard]] double cost_of_time(std::size_t before, std::size_t step_before,
                                    std::size_t excitation, std::size_t step) const;
  [[nodiscard]] Choice choose(std::size_t excitation, std::size_t step) const;
  [[nodiscard]] const Choice& at(std::size_t excitation, std::size_t step) const {
    return choices_[excitation * plan_.size() + step];
  }

  std::span<const RecipeStep* const> plan_;
  std::span<const ExcitationInRun> excitations_;
  double order_;
  std::vector<double> begins_s_; // of the steps, as planned, from the first one's
  double rate_rel_;              // of what the records show against the plan
  double overhead_s_;            // from one step to the next, beside what it lasts
  std::vector<Choice> choices_;
};

std::optional<std::size_t> Places::first_like(const FoundExcitation& found) const {
  const auto like = std::find_if(plan_.begin(), plan_.end(),
                                 [&](const RecipeStep* step) { return could_be(found, *step); });
  return like == plan_.end() ? std::nullopt
                             : std::optional(static_cast<std::size_t>(like - plan_.begin()));
}

double Places::common_rate() const {
  std::vector<double> rates;
  for (const ExcitationInRun& one : excitations_) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const RecipeStep* step : plan_) {
      const double rate = one.shown->window.frequency_hz / step->frequency.hz() - 1.0;
      nearest = std::abs(rate) < std::abs(nearest) ? rate : nearest;
    }
    rates.push_back(nearest);
  }
  return rates.empty() ? 0.0 : analysis::upper_median(rates);
}

double Places::usual_overhead_s() const {
  std::vector<double> overheads;
  for (std::size_t i = 1; i < excitations_.size(); ++i) {
    if (const auto step = first_like(*excitations_[i - 1].shown)) {
      const std::int64_t between_ns = excitations_[i].begin_ns - excitations_[i - 1].begin_ns;
      overheads.push_back(static_cast<double>(between_ns) * 1e-9 - excited_s(*step));
    }
  }
  return overheads.empty() ? 0.0 : std::max(0.0, analysis::upper_median(overheads));
}

// REQUIRES: the excitation could be the step.
double Places::worth(std::size_t excitation, std::size_t step) const {
  const ExcitationInRun& one = excitations_[excitation];
  const RecipeStep& planned = *plan_[step];
  const double off_rel =
      one.shown->window.frequency_hz / (planned.frequency.hz() * (1.0 + rate_rel_)) - 1.0;
  double cost = std::min(max_cost, std::abs(off_rel) / clock_rel);
  if (one.shown->level_m_s2 && planned.level_m_s2 > 0.0 && *one.shown->level_m_s2 > 0.0) {
    cost += level_weight * std::abs(std::log(*one.shown->level_m_s2 / planned.level_m_s2));
  }
  return (one.is_complete ? worth_of_a_pair : worth_of_one) - cost +
         order_ * static_cast<double>(step);
}

double Places::cost_of_time(std::size_t before, std::size_t step_before, std::size_t excitation,
                            std::size_t step) const {
  const std::int64_t between_ns = excitations_[excitation].begin_ns - excitations_[before].begin_ns;
  const double planned_s = begins_s_[step] - begins_s_[step_before];
  const double off_s = static_cast<double>(between_ns) * 1e-9 - planned_s;
  return std::min(max_cost, std::abs(off_s) / (excited_s(step_before) + overhead_s_));
}

Choice Places::choose(std::size_t excitation, std::size_t step) const {
  if (!could_be(*excitations_[excitation].shown, *plan_[step])) {
    return {};
  }
  Choice best{.worth = -cost_of_left_out * static_cast<double>(excitation)};
  const std::size_t first = excitation > max_left_out ? excitation - max_left_out - 1 : 0;
  for (std::size_t before = first; before < excitation; ++before) {
    for (std::size_t step_before = 0; step_before < step; ++step_before) {
      const double so_far = at(before, step_before).worth;
      if (so_far <= best.worth) { // a cost makes it less
        continue;
      }
      const double worth = so_far - cost_of_time(before, step_before, excitation, step) -
                           cost_of_left_out * static_cast<double>(excitation - before - 1);
      if (worth > best.worth) {
        best = {worth, before, step_before};
      }
    }
  }
  best.worth += worth(excitation, step);
  return best;
}

std::vector<std::optional<std::size_t>> Places::best() {
  std::optional<std::pair<std::size_t, std::size_t>> last;
  for (std::size_t i = 0; i < excitations_.size(); ++i) {
    for (std::size_t step = 0; step < plan_.size(); ++step) {
      Choice& choice = choices_[i * plan_.size() + step];
      choice = choose(i, step);
      if (std::isfinite(choice.worth) &&
          (!last || choice.worth > at(last->first, last->second).worth)) {
        last = {i, step};
      }
    }
  }
  std::vector<std::optional<std::size_t>> places(excitations_.size());
  while (last) {
    const auto [excitation, step] = *last;
    places[excitation] = step;
    const Choice& choice = at(excitation, step);
    last =
        choice.before ? std::optional(std::pair(*choice.before, choice.step_before)) : std::nullopt;
  }
  return places;
}

} // namespace

std::vector<std::optional<std::size_t>>
place_excitations(std::span<const RecipeStep* const> plan,
                  std::span<const ExcitationInRun> excitations, bool begins_late) {
  return Places(plan, excitations, begins_late).best();
}

} // namespace dyncal::inline evaluation
