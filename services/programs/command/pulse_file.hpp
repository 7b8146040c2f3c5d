// Reads records of the edges of pulse-per-second inputs, as the DAU prints them on its serial line
// and a terminal program logs them:
//
//   GPST;n;ticks      edge n of the GPS receiver's pulse, at this reading of the capture counter
//   REFT;n;ticks      edge n of the reference pulse
//   n;ticks           edge n of the GPS receiver's pulse, from firmware with one input
//
// n and ticks are decimal, without sign. Empty lines and lines that begin with # are passed over;
// line ends may be those of Windows. Several files are one record in the order given. Nothing is
// guessed: a line of another form is an error with file and line.
//
// Fails (bad_file): a file that cannot be opened, a line that is none of these, lines of two fields
// among lines of three, no edges. Any thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "analysis/instrument/pulse_edges.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline programs {

struct PulseRecord {
  std::vector<analysis::PulseEdge> edges;

  // "FILE: line N" of an edge.
  [[nodiscard]] std::string place(std::size_t edge) const;

  struct Place {
    std::size_t file = 0;
    std::size_t line = 0;
  };
  std::vector<std::filesystem::path> files;
  std::vector<Place> places; // as many as edges
};

[[nodiscard]] Expected<PulseRecord> read_pulse_files(std::span<const std::filesystem::path> files);

} // namespace dyncal::inline programs
