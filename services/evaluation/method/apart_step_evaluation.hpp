// From the samples of one excitation step to its results, when the sensors under calibration have
// stamps of their own on the time scale that links them to the reference (sensors on CAN):
//   absolute time          ACS and sensors are all stamped in UTC
//   (analysis/method/analogue_comparison.hpp) sample time stamping   sync is recorded beside the
//   sensors by a DAU on the same time scale (analysis/method/sample_stamping.hpp)
// Each source is cut to the stretch of the clock that found the step. What the descriptions and
// stamps say of their uncertainty becomes the offset between the clocks; where a source says
// nothing of it, a flag does. A step that cannot be evaluated gives results that are not valid and
// name the reason. No state; the same samples give the same bits.
#pragma once

#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/evaluation/recipe.hpp"
#include "services/evaluation/source_record.hpp"
#include "services/evaluation/step_message.hpp"

namespace dyncal::services {

struct ApartStep {
  const SourceRecord& acs;
  StretchOfTime acs_stretch; // also that of the sensors when everything is on UTC
  const SourceRecord* sync =
      nullptr; // the DAU that records sync beside the sensors; null: absolute time
  StretchOfTime sync_stretch;
};

[[nodiscard]] std::vector<wire::CalibrationResult>
evaluate_apart_step(const Recipe& recipe, const RecipeStep& step, const ApartStep& samples,
                    const std::vector<const SourceRecord*>& sensors,
                    const std::vector<std::string>& flags);

} // namespace dyncal::services
