// What the bus shows now as a table for people that stays within a terminal: a line a bench, below
// it a line a source and a line a channel that responds, of current runs only; below all benches a
// line for each host whose clock is off.
//
// Where there is no room for all, what is wrong comes first, then channels and sources of benches
// that run, then the others; the last line says how many lines were left out. No line is longer
// than the terminal is wide. A channel with flags says which where there is room for its name, else
// how many results have some. Plain functions, any thread.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "services/network/bus_state.hpp"

namespace dyncal::inline programs {

struct TableLayout {
  std::size_t columns = 80;
  std::size_t rows = 24; // 0: as many as there are
  bool colour = false;
  bool all = false;   // every channel, also of runs that are over, benches that are gone, and the
                      // clock of every host
  bool flags = false; // every flag of a channel, and what those that are shown mean
};

// One text a line, without line ends.
[[nodiscard]] std::vector<std::string> laboratory_table(const network::BusState& laboratory,
                                                        const TableLayout& layout);

} // namespace dyncal::inline programs
