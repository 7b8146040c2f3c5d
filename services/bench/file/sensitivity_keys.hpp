// The key `sensitivity` of [sources.NAME]: the response over frequency of single channels, each
// from a file of the form of the reference's (reference_file.hpp).
//
//   sensitivity = { velocity = "vibrometer.toml", charge = "amplifier.csv" }
//
// Where the file has [channel], the values are divided by that sensitivity, as by a scale factor in
// `units`. What then is left of the response over frequency is taken from the results: that of
// method.reference is what corrections.reference would name, by that of a channel of method.dut H
// is divided. Other channels have none.
//
// What cannot be is refused in the table. Any thread.
#pragma once

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/named_files.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// REQUIRES: the units of the source have been read.
void read_sensitivities(TomlTable& table, NamedFiles& files, SourceSettings& source);

// Gives what has been read to the channels with a role. `sources` is the table of all.
void assign_sensitivities(TomlTable sources, BenchFile& file);

} // namespace dyncal::inline bench
