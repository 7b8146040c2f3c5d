#include "services/programs/analysis/live_limits.hpp"

namespace dyncal::inline programs {
namespace {

// More trials take so long (milliseconds a channel) that reception and other benches must not wait
// for them; what more steps tell together at the end of a run, as well.
constexpr std::uint64_t quick_trials = 5000;
constexpr std::size_t quick_steps = 20;

} // namespace

EvaluationLimits live_limits(const Recipe& recipe) {
  EvaluationLimits limits;
  const bool is_costly = recipe.monte_carlo_trials > quick_trials;
  limits.evaluations_at_once = is_costly ? 1 : 0;
  limits.ahead = !is_costly;
  limits.never_waits = is_costly || recipe.steps.size() > quick_steps;
  return limits;
}

} // namespace dyncal::inline programs
