#include "services/evaluation/record/step_order.hpp"

#include <algorithm>
#include <map>

namespace dyncal::inline evaluation {

std::size_t StepOrder::index(std::size_t place) const {
  return place < planned() ? place * lines_ : repeats_[place - planned()].index;
}

std::uint32_t StepOrder::attempt(std::size_t place) const {
  return place < planned() ? 1 : repeats_[place - planned()].attempt;
}

std::optional<std::size_t> StepOrder::index_of(std::uint32_t step) const {
  const auto found = std::ranges::find(recipe_.steps, step, &RecipeStep::step);
  if (found == recipe_.steps.end()) {
    return std::nullopt;
  }
  const auto index = static_cast<std::size_t>(found - recipe_.steps.begin());
  return index / lines_ * lines_;
}

std::optional<std::size_t> StepOrder::find(std::uint32_t step, std::uint32_t attempt) const {
  const auto index = index_of(step);
  if (!index) {
    return std::nullopt;
  }
  if (attempt <= 1) {
    return *index / lines_;
  }
  const auto found = std::ranges::find_if(repeats_, [&](const Repeat& repeat) {
    return repeat.index == *index && repeat.attempt == attempt;
  });
  return found == repeats_.end()
             ? std::nullopt
             : std::optional(planned() + static_cast<std::size_t>(found - repeats_.begin()));
}

void StepOrder::repeat(const std::vector<std::uint32_t>& steps) {
  std::map<std::uint32_t, std::uint32_t> attempts;
  for (const std::uint32_t step : steps) {
    repeat(step, 2 + attempts[step]++);
  }
}

void StepOrder::repeat(std::uint32_t step, std::uint32_t attempt) {
  const auto index = index_of(step);
  if (index && attempt > 1 && !find(step, attempt)) {
    repeats_.push_back({*index, attempt});
  }
}

} // namespace dyncal::inline evaluation
