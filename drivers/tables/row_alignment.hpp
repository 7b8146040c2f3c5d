// Which row of a table is of which step, by their order and their frequencies alone.
//
// A row may be of a step where the frequencies differ by no more than 1 %; each row is of one step,
// each step has one row, and both keep their order. Of all such ways those count that give most
// steps a row (longest common subsequence). A step has a row where all of these ways give it the
// same one; it has none where all of them give it none; else it is not certain, and has none that
// may be used. Rows that no step has are over. The work is rows times steps. Any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace dyncal::drivers::tables {

struct StepRow {
  std::optional<std::size_t> row{};    // of the rows given
  bool certain = true;                 // that it has this one, or none
  std::vector<std::size_t> possible{}; // rows, where it is not certain
  bool operator==(const StepRow&) const = default;
};

inline constexpr double same_frequency_rel = 0.01;
// Rows times steps that are compared; callers refuse more.
inline constexpr std::size_t max_compared = 50'000'000;

// In the order of the steps. REQUIRES: no more than `max_compared`.
[[nodiscard]] std::vector<StepRow> align_rows(std::span<const double> step_frequencies_hz,
                                              std::span<const double> row_frequencies_hz);

} // namespace dyncal::drivers::tables
