// The instruments of a run as they described themselves, for documents: one for each source, and
// the ADC that recorded sync with the file of its calibration. The source of the sensor is the unit
// that acquires it, which has no name of its own. Plain function; any thread.
#pragma once

#include <string>
#include <vector>

#include "services/contract/reference_standard.hpp"
#include "services/views/language/language.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::vector<CalibratedDevice>
run_equipment(const StoredResult& result, const std::string& channel, Language language);

} // namespace dyncal::inline views
