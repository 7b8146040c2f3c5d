#include "services/programs/analysis/run_conductor.hpp"

#include <utility>

#include <spdlog/spdlog.h>

namespace dyncal::inline programs {

RunConductor::Claim RunConductor::judge(const wire::Measurement& measurement,
                                        std::chrono::nanoseconds unheard,
                                        std::chrono::nanoseconds alive_limit) {
  const bool is_other = measurement.conductor() != name_;
  const bool other_recipe = measurement.recipe_sha256() != recipe_sha256_;
  if (!other_recipe && !(is_other && measurement.state() == wire::MEASUREMENT_PLANNED)) {
    is_resumed_ = is_resumed_ || is_other;
    name_ = measurement.conductor();
    return Claim::this_run;
  }
  if (!std::exchange(other_run_said_, true)) {
    spdlog::warn("bench {}, run {}: {} announces another run of this name{}; it is not taken for "
                 "the one of {}: give it another name",
                 measurement.bench().to_string(), measurement.run().to_string(),
                 measurement.conductor(), other_recipe ? ", of another recipe" : "", name_);
  }
  // Unless two have one name, of which one lives.
  const bool resumes = measurement.state() == wire::MEASUREMENT_RUNNING && is_other;
  return resumes && unheard > alive_limit ? Claim::resumes_wrongly : Claim::another_run;
}

} // namespace dyncal::inline programs
