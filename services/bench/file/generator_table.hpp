// The table [generator] of a bench file: what excites the bench, and the limits of its level. Any
// thread.
#pragma once

#include "services/bench/file/bench_file.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

// What cannot be, or not together with this excitation, is refused in the table.
[[nodiscard]] GeneratorSettings read_generator(TomlTable table,
                                               const ExcitationSettings& excitation);

} // namespace dyncal::inline bench
