// From the samples of one excitation step to its results when sensor and reference are channels of
// one system: the analogue method, paper eqs. (1) and (2)
// (analysis/method/analogue_comparison.hpp).
//
// A step that cannot be evaluated gives results that are not valid and name the reason. No state;
// the same samples give the same bits.
#pragma once

#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/evaluation/recipe.hpp"
#include "services/evaluation/source_record.hpp"
#include "services/evaluation/step_message.hpp"

namespace dyncal::services {

[[nodiscard]] std::vector<wire::CalibrationResult>
evaluate_analogue_step(const Recipe& recipe, const RecipeStep& step, const SourceRecord& acs,
                       StretchOfTime stretch, std::vector<std::string> flags);

} // namespace dyncal::services
