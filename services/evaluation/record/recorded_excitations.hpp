// All excitations that one channel of a record shows, in the order of their instants, whatever was
// planned; and between which stamps the record has samples at all. Times are of the record's own
// clock. Plain data; any thread.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/step/excitation_window.hpp"
#include "services/evaluation/record/time_interval.hpp"

namespace dyncal::inline evaluation {

struct FoundExcitation {
  analysis::ExcitationWindow window{};
  std::int64_t frame_ns = 0; // of the search: begin and end are known to about one
  // End of the excitation before it, or of the part of the same one that came before.
  std::int64_t search_from_ns = std::numeric_limits<std::int64_t>::min();
  std::optional<double> level_m_s2{}; // of the reference, where it is of this record
  // It may have begun before, or gone on behind: the record begins or ends there, or has a hole.
  bool begin_is_cut = false;
  bool end_is_cut = false;

  [[nodiscard]] std::int64_t begin_ns() const { return window.excited_begin_ns; }
  [[nodiscard]] std::int64_t end_ns() const { return window.off_ns; }
  [[nodiscard]] std::int64_t middle_ns() const { return begin_ns() + (end_ns() - begin_ns()) / 2; }
};

struct RecordedExcitations {
  std::string channel; // "source/name"
  std::string source;
  std::vector<FoundExcitation> found{};
  // Of samples whose stamps are trusted: from the first to the last, and where there are none for
  // longer than a short step.
  TimeInterval recorded{};
  std::vector<TimeInterval> holes{};
  double untrusted_part = 0.0; // of the samples; those that do not rise, too
  double length_s = 0.0;       // of the record by the number of its samples, trusted or not
};

} // namespace dyncal::inline evaluation
