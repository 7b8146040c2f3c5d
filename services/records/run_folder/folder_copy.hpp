// Copies the bench file and the files that it names into a run folder that is being made.
//
// A file is written beside, reaches the disk and then takes its name; a folder (of shots) is copied
// with the files in it. What is not there is left out: the bench file would have been refused if
// the run needed it. Fails (bad_file), naming the file.
#pragma once

#include <cstdint>
#include <filesystem>

#include "services/base/error.hpp"
#include "services/bench/file/bench_file.hpp"

namespace dyncal::inline records {

[[nodiscard]] Expected<void> copy_bench(const BenchFile& bench,
                                        const std::filesystem::path& folder);

// What copy_bench() will write.
[[nodiscard]] std::uint64_t bytes_of_bench(const BenchFile& bench);

} // namespace dyncal::inline records
