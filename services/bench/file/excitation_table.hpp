// The table [excitation] of a bench file: which steps a run has, and what part of them is
// evaluated. Any thread.
#pragma once

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// What cannot be is refused in the table.
[[nodiscard]] ExcitationSettings read_excitation(TomlTable table);

} // namespace dyncal::inline bench
