// How the table of an analogue calibration system is read and what its columns mean: the keys of a
// source with driver = "table" (deploy/guide/bench-file.md). What a table cannot say and a wrong
// guess would turn into a wrong number has no default. Plain data; any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "drivers/tables/reference_table.hpp"

namespace dyncal::drivers::tables {

enum class TableAmplitude { peak, rms };
[[nodiscard]] constexpr const char* to_string(TableAmplitude amplitude) {
  return amplitude == TableAmplitude::peak ? "peak" : "rms";
}

// What its phase is, in degrees of lead.
enum class TablePhase { sync_minus_reference, reference_minus_sync };
[[nodiscard]] constexpr const char* to_string(TablePhase phase) {
  return phase == TablePhase::sync_minus_reference ? "sync-minus-reference"
                                                   : "reference-minus-sync";
}

struct TableSettings {
  std::vector<std::filesystem::path> paths; // a file with loops; or a file a loop; or their folder
  std::optional<TableFormat> format{};      // empty: by the content
  TableAmplitude amplitude = TableAmplitude::peak;
  TablePhase phase = TablePhase::sync_minus_reference;
  double phase_offset_deg = 0.0;           // added to sync - reference
  std::optional<double> coverage{};        // standard uncertainties in a deviation of the table
  std::optional<double> u_amplitude_rel{}; // in place of the table's deviations
  std::optional<double> u_phase_deg{};
  std::optional<std::int64_t> first_loop{}; // number of the loop that is repetition 1; empty: 0
  std::size_t skip_first_rows = 0;          // of every loop
  std::size_t skip_last_rows = 0;
  bool operator==(const TableSettings&) const = default;
};

} // namespace dyncal::drivers::tables
