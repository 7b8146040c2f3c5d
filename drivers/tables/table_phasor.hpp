// What a row of a table says of the excitation and of sync, as the evaluation takes it.
//
//   a_T in m/s^2 (peak);  psi_T = theta_sync - theta_ref = +-phase + phase_offset, radians of lead
//   u = deviation / coverage, or as the bench file states it
//
// Fails (invalid_setting) where nothing states an uncertainty: a table without deviations, or with
// 0 in their place, and no u in the bench file; deviations without `coverage`. Any thread.
#pragma once

#include "drivers/error.hpp"
#include "drivers/tables/reference_table_row.hpp"
#include "drivers/tables/table_settings.hpp"

namespace dyncal::drivers::tables {

struct TablePhasor {
  double amplitude_m_s2 = 0.0; // a_T
  double u_amplitude_m_s2 = 0.0;
  double phase_rad = 0.0; // psi_T
  double u_phase_rad = 0.0;
  double coverage = 1.0; // of the table's deviations; 1 where the bench file states both u
  bool operator==(const TablePhasor&) const = default;
};

// `file`: how messages name it.
[[nodiscard]] Expected<TablePhasor>
phasor_of(const ReferenceTableRow& row, const TableSettings& settings, const std::string& file);

} // namespace dyncal::drivers::tables
