// Reads the samples of a CSV file, a stretch at a time. README.md has the format; every error names file and line.
#pragma once

#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/acs/file_source.hpp"

namespace dyncal::drivers::acs {

class CsvReader : public SampleReader {
public:
  [[nodiscard]] static Expected<std::unique_ptr<CsvReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;

private:
  enum class Meaning { time, number, channel };
  struct Row {
    std::uint64_t sample = 0;
    std::int64_t stamp_ns = 0;
    std::vector<double> values;
  };

  explicit CsvReader(const FileSettings& settings) : settings_(settings) {}
  Expected<void> read_header();
  Expected<void> name_columns(const std::vector<std::string>& names);
  Expected<bool> read_row(); // into row_; false: the end
  Expected<void> parse_row(std::string_view line);
  Expected<void> check_order(std::uint64_t sample_before, std::int64_t stamp_before) const;
  template <class Number>
  Expected<Number> number(std::string_view field, std::size_t column) const;
  [[nodiscard]] tl::unexpected<Error> malformed(const std::string& problem) const;
  [[nodiscard]] tl::unexpected<Error> wrong_field(std::string_view field, std::size_t column, const char* wanted) const;

  FileSettings settings_;
  std::ifstream file_;
  std::string line_;
  std::size_t line_number_ = 0;
  char separator_ = ',';
  std::vector<std::string> columns_;
  std::vector<Meaning> meanings_;
  bool has_time_ = false;
  bool has_number_ = false;
  SourceDescription description_;
  Row row_;
  bool row_waits_ = false; // row_ belongs to the next block: a gap stands before it
  bool first_row_ = true;
};

} // namespace dyncal::drivers::acs
