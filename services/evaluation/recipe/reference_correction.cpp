#include "services/evaluation/recipe/reference_correction.hpp"

namespace dyncal::inline evaluation {

analysis::Expected<analysis::ReferenceResponse> reference_response(const Recipe& recipe,
                                                                   const RecipeStep& step) {
  if (recipe.reference_calibration.empty()) {
    return analysis::ReferenceResponse{};
  }
  return analysis::reference_response_at(recipe.reference_calibration, step.frequency.hz(),
                                         step.level_m_s2);
}

} // namespace dyncal::inline evaluation
