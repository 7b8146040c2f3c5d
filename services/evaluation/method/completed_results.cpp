#include "services/evaluation/method/completed_results.hpp"

#include "services/evaluation/method/channel_responses.hpp"
#include "services/evaluation/method/monte_carlo_check.hpp"
#include "services/evaluation/method/transverse_motion.hpp"

namespace dyncal::inline evaluation {

void complete(const Recipe& recipe, std::uint32_t attempt, std::optional<double> temperature_degc,
              const std::stop_token& stop, std::vector<StepResult>& results) {
  const std::vector<bool> has_other = take_channel_responses(recipe, results);
  const std::vector<bool> has_more = add_transverse_motion(recipe, results);
  for (std::size_t i = 0; i < results.size(); ++i) {
    results[i].attempt = attempt;
    results[i].temperature_degc = temperature_degc;
    if (has_other[i] || has_more[i]) {
      redo_monte_carlo_check(recipe.monte_carlo_trials, stop, results[i]);
    }
  }
}

} // namespace dyncal::inline evaluation
