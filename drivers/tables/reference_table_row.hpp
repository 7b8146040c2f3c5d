// One row of the table that an analogue calibration system hands out: what it has measured in one
// step. As it stands in the file: which of the two signals leads, peak or rms, and how many
// standard uncertainties a deviation is, the laboratory states (table_phasor.hpp). Plain data; any
// thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace dyncal::drivers::tables {

struct ReferenceTableRow {
  std::size_t line = 0;             // in its file, from 1
  std::optional<std::int64_t> loop; // as the file numbers it; empty: it holds one loop
  double frequency_hz = 0.0;
  double amplitude_m_s2 = 0.0;
  std::optional<double> amplitude_deviation_m_s2{};
  double phase_deg = 0.0; // between sync and reference
  std::optional<double> phase_deviation_deg{};
  std::optional<double> distortion_reference_rel{};
  std::optional<double> distortion_sync_rel{};
  bool operator==(const ReferenceTableRow&) const = default;
};

} // namespace dyncal::drivers::tables
