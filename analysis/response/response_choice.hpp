// Which order of a parametric model the measured values support.
//
//   chi^2_k = r' V^-1 r       nu_k = 2 n - p_k        P = Q(chi^2_k, nu_k)      does kind k fit?
//   AIC_k = chi^2_k + 2 p_k                           BIC_k = chi^2_k + p_k ln 2 n
//   Q(chi^2_a - chi^2_b, p_b - p_a) < 0.01            b is better than a by more than chance
//
// V is known (response_fit.hpp), so that the difference of two chi-squared is the likelihood ratio.
// The choice begins with the best of the fewest parameters and goes on, as long as one is better by
// more than chance, to the kind with the fewest more parameters that is; kinds whose parameters the
// values do not determine are left out. AIC and BIC are stated beside it.
//
// A choice is not a fit: `fits` is false when P < 0.001 for the chosen kind. Fails when no kind
// could be fitted, with the reason of the simplest. Any thread.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/response/response_fit.hpp"

namespace dyncal::analysis {

struct ResponseCandidate {
  ResponseKind kind = ResponseKind::gain;
  std::optional<FittedResponse> fit;
  std::string problem; // why there is no fit
  double probability = 0.0;
  double aic = 0.0;
  double bic = 0.0;

  [[nodiscard]] bool eligible() const { return fit && fit->undetermined.empty(); }
};

// The chosen kind against another.
struct ResponseRivalry {
  ResponseKind kind = ResponseKind::gain;
  double chi_squared_gain = 0.0; // of the one with more parameters
  int more_parameters = 0;       // of the one that has them
  double probability = 0.0;      // that chance gives that gain
};

struct ResponseChoice {
  std::vector<ResponseCandidate> candidates; // in the order of their kinds
  std::size_t chosen = 0;
  bool fits = false;
  std::optional<ResponseRivalry> simpler; // the best with fewer parameters
  std::optional<ResponseRivalry> richer;  // of those with more, the least likely by chance

  [[nodiscard]] const ResponseCandidate& best() const { return candidates[chosen]; }
};

// `wanted`: this kind is chosen, whatever the values say; fails when it could not be fitted.
[[nodiscard]] Expected<ResponseChoice>
choose_response(std::span<const ResponsePoint> points, const CommonResponseUncertainty& common = {},
                std::optional<ResponseKind> wanted = std::nullopt);

} // namespace dyncal::analysis
