// Numbers out of a stretch of whole lines of a CSV file, without any state, so that stretches are read by several threads at once.
// README.md has the format. Numbers by std::from_chars: integers stay integers, shortest decimals come back bit for bit.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/error.hpp"

namespace dyncal::drivers::acs {

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

  std::size_t rows = 0;
  std::size_t lines = 0;
  std::vector<std::int64_t> stamps_ns;       // empty without a time column
  std::vector<std::uint64_t> sample_numbers; // empty without a column of them
  std::unique_ptr<double[]> values;          // channel after channel, `capacity` rows each
  std::size_t capacity = 0;
  std::optional<Problem> problem;

  [[nodiscard]] const double* channel(std::size_t index) const { return values.get() + index * capacity; }
};

// Also checks that stamps and sample numbers rise within the stretch.
[[nodiscard]] CsvRows read_csv_rows(std::string_view lines, const CsvLayout& layout);

} // namespace dyncal::drivers::acs
