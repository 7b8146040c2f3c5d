// Numbers out of a stretch of whole lines of a CSV file, without any state, so that stretches are
// read by several threads at once. README.md has the format. Integers stay integers, decimals are
// rounded exactly (decimal.hpp): shortest ones come back bit for bit.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/error.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::files {

enum class CsvMeaning { time, number, channel };

// What the first line says.
struct CsvLayout {
  char separator = ',';
  std::vector<std::string> columns;
  std::vector<CsvMeaning> meanings;
  std::vector<std::string> channels;
  bool has_time = false;
  bool has_number = false;

  // Fails with the problem alone, for the caller to say in which file.
  [[nodiscard]] static tl::expected<CsvLayout, std::string> of(std::string_view first_line);
};

struct CsvRows {
  struct Problem {        // of the first line that cannot be read; the rows before it can be used
    std::size_t line = 0; // of the stretch, from 0
    std::string sentence;
  };
  static constexpr std::size_t block_rows = 4096;

  // Of up to `block_rows` rows; a gap in the sample numbers ends one. Stamps as they are in the
  // file, none without a time column. Without a column of sample numbers `first_sample` counts from
  // the beginning of the stretch.
  std::vector<SampleBlock> blocks;
  std::size_t lines = 0;
  std::optional<Problem> problem;
};

// Also checks that sample numbers rise within the stretch.
[[nodiscard]] CsvRows read_csv_rows(std::string_view lines, const CsvLayout& layout);

} // namespace dyncal::drivers::files
