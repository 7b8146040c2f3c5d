// The drift of a sensor over its calibrations: for every channel and frequency the values by time,
// how far each is from the first, and E_n against the one before
// (analysis/response/comparison.hpp).
//
//   deviation    magnitude: (|H| - |H|_first) / |H|_first; phase: modulo 2 pi, in (-pi, pi]
//   E_n          with U of both; nothing for the first, across a change of unit or level, and
//                between two evaluations of one run
//
// Values that are not known, and uncertainties that are not positive, are left out. Plain
// functions, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "services/records/store/store.hpp"

namespace dyncal::inline records {

struct HistoryValue {
  std::size_t calibration = 0; // index into History::calibrations
  StoredValue point;
  double deviation_magnitude_rel = 0.0;
  double deviation_phase_rad = 0.0;
  std::optional<double> en_magnitude{};
  std::optional<double> en_phase{};

  [[nodiscard]] bool agrees() const; // |E_n| <= 1, or there is none
};

struct HistoryLine { // one channel at one frequency, by time
  std::string channel;
  std::string frequency_text_hz;
  double frequency_hz = 0.0;
  std::vector<HistoryValue> values; // not empty
};

struct History {
  std::string sensor;
  std::vector<Calibration> calibrations;
  std::vector<HistoryLine> lines; // by channel, then frequency
};

// `channel`, `frequency_hz`: only these, if given.
[[nodiscard]] History history_of(std::string sensor, std::vector<Calibration> calibrations,
                                 const std::string& channel = "",
                                 std::optional<double> frequency_hz = {});

} // namespace dyncal::inline records
