#include "services/instruments/reference_steps.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "analysis/base/frequency.hpp"
#include "drivers/tables/table_files.hpp"
#include "drivers/tables/table_phasor.hpp"

namespace dyncal::inline instruments {
namespace {

namespace tables = drivers::tables;

constexpr std::size_t max_extra_named = 10;

} // namespace

const tables::TableSettings& table_settings_of(const SourceSettings& source) {
  return std::get<TableSourceSettings>(source.driver);
}

Error table_error(const SourceSettings& source, const drivers::Error& error) {
  return {ErrorCode::bad_file, fmt::format("source '{}': {}", source.name, error.message)};
}

drivers::SourceDescription describe_table(const SourceSettings& source) {
  drivers::SourceDescription description;
  description.device = source.identity.device;
  description.serial = source.identity.serial;
  description.firmware = source.identity.firmware;
  description.driver = "table";
  description.channels = {
      {.name = "reference", .quantity = "acceleration", .unit = reference_step_unit},
      {.name = "sync", .quantity = "", .unit = R"(\one)"}};
  description.time_base = source.time_base;
  return description;
}

std::vector<tables::PlannedRow> planned_rows(const std::vector<PlannedReferenceStep>& plan) {
  std::vector<tables::PlannedRow> rows;
  for (const PlannedReferenceStep& step : plan) {
    const auto frequency = analysis::Frequency::parse(step.frequency_text_hz);
    rows.push_back({step.repetition, frequency ? frequency->hz() : 0.0}); // 0: of no row
  }
  return rows;
}

ReferenceStep missing_step(const PlannedReferenceStep& planned, std::string problem) {
  return {.step = planned.step,
          .repetition = planned.repetition,
          .frequency_text_hz = planned.frequency_text_hz,
          .problem = std::move(problem)};
}

Expected<ReferenceStep> reference_step_of(const SourceSettings& source,
                                          const PlannedReferenceStep& planned,
                                          const tables::LoopRow& row) {
  const auto phasor = tables::phasor_of(*row.row, table_settings_of(source), row.file->name);
  if (!phasor) {
    return fail(table_error(source, phasor.error()));
  }
  return ReferenceStep{.step = planned.step,
                       .repetition = planned.repetition,
                       .frequency_text_hz = planned.frequency_text_hz,
                       .amplitude_m_s2 = phasor->amplitude_m_s2,
                       .u_amplitude_m_s2 = phasor->u_amplitude_m_s2,
                       .phase_rad = phasor->phase_rad,
                       .u_phase_rad = phasor->u_phase_rad,
                       .distortion_reference_rel = row.row->distortion_reference_rel.value_or(0.0),
                       .distortion_sync_rel = row.row->distortion_sync_rel.value_or(0.0),
                       .coverage = phasor->coverage,
                       .origin = tables::name_of(row)};
}

std::string rows_of_no_step(const tables::TableMatch& match) {
  const std::size_t count = std::min(match.extra.size(), max_extra_named);
  return fmt::format("{} of the table's rows are of no step of the plan: {}{}; take test tones out "
                     "with skip_first_rows and skip_last_rows, or put the steps into the plan",
                     match.extra.size(),
                     fmt::join(match.extra.begin(),
                               match.extra.begin() + static_cast<std::ptrdiff_t>(count), ", "),
                     match.extra.size() > count ? ", ..." : "");
}

Expected<std::vector<ReferenceStep>>
read_reference_steps(const SourceSettings& source, const std::vector<PlannedReferenceStep>& plan) {
  const auto files = tables::read_table_files(table_settings_of(source));
  if (!files) {
    return fail(table_error(source, files.error()));
  }
  const auto match = tables::match_table(*files, planned_rows(plan), table_settings_of(source));
  if (!match) {
    return fail(table_error(source, match.error()));
  }
  if (!match->extra.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("source '{}': {}", source.name, rows_of_no_step(*match)));
  }
  std::vector<ReferenceStep> steps;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    if (match->steps[i].at.row == nullptr) {
      steps.push_back(missing_step(plan[i], match->steps[i].problem));
    } else {
      DYNCAL_TRY(steps.emplace_back(), reference_step_of(source, plan[i], match->steps[i].at));
    }
  }
  return steps;
}

} // namespace dyncal::inline instruments
