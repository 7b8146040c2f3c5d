// The row of every step of a plan, out of the files of a table.
//
// 1. Rows belong to a loop: by the numbers of the file, or, of several files, by which one they
//    stand in. Loops are the repetitions of the plan in their order; `first_loop` is repetition 1.
// 2. `skip_first_rows` and `skip_last_rows` of every loop are no steps (test tones, repeated ones).
// 3. Within a loop the rows are aligned with the steps of its repetition (row_alignment.hpp).
//
// A step without a row, or whose row is not certain, says why in one sentence with its frequency;
// it never gets the row of another step. Rows that no step has are named one by one. Fails
// (invalid_setting) where the loops do not tell which repetition they are, and where there are too
// many rows to compare. Any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/tables/table_settings.hpp"

namespace dyncal::drivers::tables {

struct TableFile {
  std::string name; // as messages give it
  std::vector<ReferenceTableRow> rows;
  bool operator==(const TableFile&) const = default;
};

struct PlannedRow {
  std::uint32_t repetition = 1;
  double frequency_hz = 0.0;
};

// The rows of every loop that are steps, or may be, by repetition - 1. Fails as match_table() does.
struct LoopRow {
  const TableFile* file = nullptr;
  const ReferenceTableRow* row = nullptr;
};
[[nodiscard]] Expected<std::vector<std::vector<LoopRow>>> loops_of(std::span<const TableFile> files,
                                                                   const TableSettings& settings);
[[nodiscard]] std::vector<double> frequencies_of(std::span<const LoopRow> rows);

// "FILE: line 21 (80 Hz)"
[[nodiscard]] std::string name_of(const LoopRow& row);

// Why a step has no row: there is none, or which rows it may have.
[[nodiscard]] std::string lacking_row(double frequency_hz, std::span<const LoopRow> possible);

struct MatchedRow {
  LoopRow at{};          // among those of the files; empty where there is none
  std::string problem{}; // where there is none
};

struct TableMatch {
  std::vector<MatchedRow> steps;  // in the order of the plan
  std::vector<std::string> extra; // rows that no step has: "FILE: line 21 (80 Hz)"
};

[[nodiscard]] Expected<TableMatch> match_table(std::span<const TableFile> files,
                                               std::span<const PlannedRow> plan,
                                               const TableSettings& settings);

} // namespace dyncal::drivers::tables
