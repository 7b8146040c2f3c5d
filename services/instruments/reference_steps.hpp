// The steps of a run out of the table of a system that evaluates itself (driver "table").
//
// Fails (bad_file) as drivers/tables does, with the source's name before it; where rows are no
// steps of the plan and no key says so, with all of their names. Plain functions; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/contract/reference_step.hpp"

namespace dyncal::inline instruments {

struct PlannedTableStep {
  std::uint32_t step = 0;
  std::uint32_t repetition = 0;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
};

// Its channels are those that reference and sync would be; no samples come of them.
[[nodiscard]] drivers::SourceDescription describe_table(const SourceSettings& source);

// In the order of the plan; those that have no row say so. REQUIRES: driver "table".
[[nodiscard]] Expected<std::vector<ReferenceStep>>
read_reference_steps(const SourceSettings& source, const std::vector<PlannedTableStep>& plan);

} // namespace dyncal::inline instruments
