// Whether what was published of a run is what another evaluation of it gives.
//
// Two values agree where magnitude and phase differ by at most 0.01 of the larger u, and u by at
// most 1 % of it: the same samples give the same bits, and what a computer of another kind rounds
// otherwise is far below. A mean and a group delay are held in the same way. A value for which the
// other evaluation has fewer samples, later ones in their place, or none, is missing: it says
// nothing about the published one. What the other one has beyond is left out. Phases are compared
// modulo 2 pi. Pure functions, any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline evaluation {

struct OutcomeAgreement {
  std::size_t values = 0;    // valid ones that were published
  std::size_t missing = 0;   // of them
  std::size_t differing = 0; // of them
  std::string difference;    // the first one, of a value or a mean; empty: all that is there agrees
};

// Whether it is the same single result, of no fewer samples: what can be held against each other.
[[nodiscard]] bool gives_again(const StepResult& again, const StepResult& published);

[[nodiscard]] OutcomeAgreement hold_against(const RunOutcome& published, const RunOutcome& again);

// The first point or delay of `published` that `again` does not have so; empty: none. A point that
// only one of them has is a difference.
[[nodiscard]] std::string mean_difference(const TransferFunction& published,
                                          const TransferFunction& again);

// Results have no signature: a mean of `outcome` that is not that of its points is somebody else's.
// The one of its points takes its place, or none; a sentence for each. REQUIRES: a recipe
[[nodiscard]] std::vector<std::string> replace_foreign_means(RunOutcome& outcome);

// Of an outcome that lacks something that its analysis has published, or will: means are those of
// the results that are there, also of channels whose mean has not come. REQUIRES: a recipe
void take_means_of_results(RunOutcome& outcome);

} // namespace dyncal::inline evaluation
