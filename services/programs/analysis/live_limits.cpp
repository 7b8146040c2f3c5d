#include "services/programs/analysis/live_limits.hpp"

namespace dyncal::inline programs {
namespace {

// More trials take so long (milliseconds a channel) that reception and other benches must not wait
// for them.
constexpr std::uint64_t quick_trials = 5000;

} // namespace

EvaluationLimits live_limits(const Recipe& recipe) {
  EvaluationLimits limits;
  if (recipe.monte_carlo_trials > quick_trials) {
    limits.evaluations_at_once = 1;
    limits.never_waits = true;
  } else {
    limits.ahead = true;
  }
  return limits;
}

} // namespace dyncal::inline programs
