// A recorded series as a whole in memory, for commands that look at one file: stamps and columns of
// a CSV, NumPy or WAV file. drivers/files/README.md has the format. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/base/work_count.hpp"

namespace dyncal::inline records {

struct SeriesFile {
  std::filesystem::path path;
  std::vector<std::string> names;
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::uint8_t> flags;           // not 0: the stamp is not in order
  std::vector<std::uint64_t> sample_numbers; // counted where the file has none
  std::vector<std::vector<double>> columns;

  // Fails (bad_argument) with the names that there are.
  [[nodiscard]] Expected<std::span<const double>> column(const std::string& name) const;
  // Leaves out samples whose stamps are not in order; returns how many.
  std::size_t leave_out_disorder();
};

// Fails (bad_file) with file and line. `count`: of its megabytes. A file without stamps has those
// of the nominal rate.
[[nodiscard]] Expected<SeriesFile>
read_series_file(const std::filesystem::path& path, const SharedWorkCount& count = nullptr,
                 std::optional<double> nominal_rate_hz = std::nullopt);

} // namespace dyncal::inline records
