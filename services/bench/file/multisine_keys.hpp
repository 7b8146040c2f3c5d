// The keys of [excitation] that a multi-sine has beside those of single frequencies, and what goes
// together with it.
//
//   kind = "multisine"    all of frequencies_hz at once; "sine": one after the other
//   period_s = 10.0       of the waveform
//   dropped_periods = 1   at the beginning of an excitation, in place of settling_s
//
// Its lines are held against each other and against the mains once [method] is known
// (analysis/sine/multisine_lines.hpp). Plain functions; a table belongs to one thread.
#pragma once

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// After the other keys of `excitation`: sets what follows from a period, its settling and its
// duration among them.
void read_multisine(TomlTable& table, ExcitationSettings& excitation);

// Refuses lines that collide and methods that have no multi-sine, in the table of the excitation.
// REQUIRES: `file` has its excitation and its method.
void check_multisine(TomlTable table, const BenchFile& file);

} // namespace dyncal::inline bench
