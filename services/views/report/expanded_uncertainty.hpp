// From the standard uncertainty of a result to its coverage interval (GUM 6, G.4):
//
//   U = k u,   k = t_p(nu_eff),   p = 95.45 %
//
// Of a single step, nu_eff is that of Welch and Satterthwaite over the rows of its budget; of a
// mean over repetitions, u, nu_eff and k are those of analysis/method/repetitions.hpp. Plain
// functions, any thread.
#pragma once

#include <string>

#include "services/evaluation/result/step_result.hpp"
#include "services/evaluation/result/transfer_function.hpp"
#include "services/views/language/language.hpp"

namespace dyncal::inline views {

struct ExpandedUncertainty {
  double u = 0.0; // k = 1
  double k = 2.0;
  double nu_eff = analysis::infinite_degrees_of_freedom;
  double expanded = 0.0; // U
};

// Above it, a table of standard uncertainties names k.
inline constexpr double notable_k = 2.05;

[[nodiscard]] ExpandedUncertainty magnitude_uncertainty(const StepResult& result);
[[nodiscard]] ExpandedUncertainty phase_uncertainty(const StepResult& result);
[[nodiscard]] ExpandedUncertainty magnitude_uncertainty(const analysis::RepetitionMean& mean);
[[nodiscard]] ExpandedUncertainty phase_uncertainty(const analysis::RepetitionMean& mean);

// ", k = 2.87" behind a standard uncertainty, where 2 u would not cover; else nothing.
[[nodiscard]] std::string notable_k_text(double k);

// Of means whose largest coverage factor is `largest_k`: one sentence on what makes it large, and
// what to do; empty where it is not. The same words in table, page, report and certificate.
[[nodiscard]] std::string advice_on_repetitions(double largest_k,
                                                Language language = Language::english);

} // namespace dyncal::inline views
