// The drift of a sensor over its calibrations: for every channel, frequency, level and excited axis
// the values by time, how far each is from the first, and E_n against the one before
// (analysis/response/comparison.hpp).
//
//   deviation    magnitude: (|H| - |H|_first) / |H|_first; phase: modulo 2 pi, in (-pi, pi]
//   E_n          with U of both, without what they have in common (common_part.hpp) where that is
//                known; nothing for the first, across a change of unit, and between two evaluations
//                of one run
//
// Open closures are those of the channels that are shown. Values that are not known, and
// uncertainties that are not positive, are left out. Plain functions, any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/result/point_identity.hpp"
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

struct HistoryLine { // one point, by time
  PointIdentity point;
  std::string frequency_text_hz;
  std::vector<HistoryValue> values; // not empty
};

struct History {
  std::string sensor;
  std::vector<Calibration> calibrations;
  std::vector<HistoryLine> lines; // in the order of their points

  // Of all its points: what titles of lines must say.
  [[nodiscard]] PointDifferences differences() const;
};

struct HistoryFilter { // empty: any
  std::string channel{};
  std::optional<double> frequency_hz{};
  std::optional<double> level_m_s2{}; // as planned
};

// Leaves out the other points.
void keep_wanted(Calibration& calibration, const HistoryFilter& filter);

[[nodiscard]] History history_of(std::string sensor, std::vector<Calibration> calibrations);

} // namespace dyncal::inline records
