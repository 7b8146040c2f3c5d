// Which file the sync ADC was corrected by, in the contract's Measurement message, so that whoever
// evaluates the run again can name it.
//
// Plain functions, any thread.
#pragma once

#include <optional>

#include "idl/dyncal.h"
#include "services/evaluation/result/run_outcome.hpp"

namespace dyncal::inline evaluation {

void add_adc_file(const std::optional<AdcFile>& file, wire::Measurement& measurement);
[[nodiscard]] std::optional<AdcFile> adc_file_of(const wire::Measurement& measurement);

} // namespace dyncal::inline evaluation
