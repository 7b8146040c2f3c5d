#include "analysis/response/response_choice.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/response/chi_squared.hpp"

namespace dyncal::analysis {
namespace {

constexpr double better_than_chance = 0.01;
constexpr double min_probability = 0.001; // of a model that fits

ResponseCandidate candidate_of(ResponseKind kind, std::span<const ResponsePoint> points,
                               const CommonResponseUncertainty& common) {
  ResponseCandidate candidate;
  candidate.kind = kind;
  auto fit = fit_response(kind, points, common);
  if (!fit) {
    candidate.problem = fit.error().message;
    return candidate;
  }
  const double p = static_cast<double>(parameter_count(kind));
  candidate.probability = chi_squared_probability(fit->chi_squared, fit->degrees_of_freedom);
  candidate.aic = fit->chi_squared + 2.0 * p;
  candidate.bic = fit->chi_squared + p * std::log(2.0 * static_cast<double>(points.size()));
  candidate.fit = std::move(*fit);
  return candidate;
}

ResponseRivalry rivalry(const ResponseCandidate& simple, const ResponseCandidate& rich,
                        ResponseKind other) {
  ResponseRivalry result;
  result.kind = other;
  result.chi_squared_gain = simple.fit->chi_squared - rich.fit->chi_squared;
  result.more_parameters =
      static_cast<int>(parameter_count(rich.kind)) - static_cast<int>(parameter_count(simple.kind));
  result.probability = chi_squared_probability(result.chi_squared_gain, result.more_parameters);
  return result;
}

// The lowest chi-squared of each number of parameters, fewest parameters first.
std::vector<std::size_t> best_of_each_size(const std::vector<ResponseCandidate>& candidates) {
  std::vector<std::size_t> best;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].eligible()) {
      continue;
    }
    const auto same = std::find_if(best.begin(), best.end(), [&](std::size_t other) {
      return parameter_count(candidates[other].kind) == parameter_count(candidates[i].kind);
    });
    if (same == best.end()) {
      best.push_back(i);
    } else if (candidates[i].fit->chi_squared < candidates[*same].fit->chi_squared) {
      *same = i;
    }
  }
  std::sort(best.begin(), best.end(), [&](std::size_t a, std::size_t b) {
    return parameter_count(candidates[a].kind) < parameter_count(candidates[b].kind);
  });
  return best;
}

std::size_t choose(const std::vector<ResponseCandidate>& candidates,
                   const std::vector<std::size_t>& by_size) {
  std::size_t here = 0;
  for (std::size_t next = here + 1; next < by_size.size(); ++next) {
    const ResponseCandidate& simple = candidates[by_size[here]];
    const ResponseCandidate& rich = candidates[by_size[next]];
    if (rivalry(simple, rich, rich.kind).probability < better_than_chance) {
      here = next;
    }
  }
  return by_size[here];
}

void add_rivals(ResponseChoice& choice) {
  const ResponseCandidate& chosen = choice.best();
  const std::size_t size = parameter_count(chosen.kind);
  for (const ResponseCandidate& other : choice.candidates) {
    if (!other.fit) {
      continue;
    }
    if (parameter_count(other.kind) < size && other.eligible()) {
      const ResponseRivalry simpler = rivalry(other, chosen, other.kind);
      if (!choice.simpler || simpler.chi_squared_gain < choice.simpler->chi_squared_gain) {
        choice.simpler = simpler;
      }
    } else if (parameter_count(other.kind) > size) {
      const ResponseRivalry richer = rivalry(chosen, other, other.kind);
      if (!choice.richer || richer.probability < choice.richer->probability) {
        choice.richer = richer;
      }
    }
  }
}

} // namespace

Expected<ResponseChoice> choose_response(std::span<const ResponsePoint> points,
                                         const CommonResponseUncertainty& common,
                                         std::optional<ResponseKind> wanted) {
  ResponseChoice choice;
  for (const ResponseKind kind : all_response_kinds) {
    choice.candidates.push_back(candidate_of(kind, points, common));
  }
  if (wanted) {
    choice.chosen = static_cast<std::size_t>(*wanted);
    if (!choice.best().fit) {
      return fail(ErrorCode::not_converged, choice.best().problem);
    }
  } else {
    const std::vector<std::size_t> by_size = best_of_each_size(choice.candidates);
    if (by_size.empty()) {
      return fail(ErrorCode::not_converged, choice.candidates.front().problem);
    }
    choice.chosen = choose(choice.candidates, by_size);
  }
  choice.fits = choice.best().probability >= min_probability;
  add_rivals(choice);
  return choice;
}

} // namespace dyncal::analysis
