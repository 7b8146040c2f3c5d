// The steps of a run out of the table of a system that evaluates itself (driver "table").
//
// Fails (bad_file) as drivers/tables does, with the source's name before it; where rows are no
// steps of the plan and no key says so, with all of their names. Plain functions; any thread.
#pragma once

#include <string>
#include <vector>

#include "drivers/sample_block.hpp"
#include "drivers/tables/table_match.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/source_settings.hpp"
#include "services/contract/reference_step.hpp"

namespace dyncal::inline instruments {

// Its channels are those that reference and sync would be; no samples come of them.
[[nodiscard]] drivers::SourceDescription describe_table(const SourceSettings& source);

// In the order of the plan; those that have no row say so. REQUIRES: driver "table".
[[nodiscard]] Expected<std::vector<ReferenceStep>>
read_reference_steps(const SourceSettings& source, const std::vector<PlannedReferenceStep>& plan);

// REQUIRES: driver "table".
[[nodiscard]] const drivers::tables::TableSettings& table_settings_of(const SourceSettings& source);
// Of one step, and of one that has no row.
[[nodiscard]] Expected<ReferenceStep> reference_step_of(const SourceSettings& source,
                                                        const PlannedReferenceStep& planned,
                                                        const drivers::tables::LoopRow& row);
[[nodiscard]] ReferenceStep missing_step(const PlannedReferenceStep& planned, std::string problem);
// One sentence that names them.
[[nodiscard]] std::string rows_of_no_step(const drivers::tables::TableMatch& match);
[[nodiscard]] Error table_error(const SourceSettings& source, const drivers::Error& error);
// The plan as tables are matched with it.
[[nodiscard]] std::vector<drivers::tables::PlannedRow>
planned_rows(const std::vector<PlannedReferenceStep>& plan);

} // namespace dyncal::inline instruments
