// Reads the samples of a CSV file, a stretch at a time; README.md has the format, every error names
// file and line.
//
// The file is mapped into memory; the next stretches of it are read by threads of their own while
// the current one is taken, two for each processor, 2 MB of text each. Samples and errors come in
// the order of the file whatever thread meets them first.
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/files/csv_rows.hpp"
#include "drivers/files/file_source.hpp"
#include "drivers/files/mapped_file.hpp"
#include "drivers/files/stamp_order.hpp"

namespace dyncal::drivers::files {

class CsvReader : public SampleReader {
public:
  [[nodiscard]] static Expected<std::unique_ptr<CsvReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override;

private:
  struct Stretch {
    std::size_t bytes = 0;
    std::future<CsvRows> rows;
  };

  CsvReader(const FileSettings& settings, MappedFile file)
      : settings_(settings), file_(std::move(file)), rest_(file_.text()) {}
  Expected<void> read_header();
  void read_ahead();
  Expected<bool> next_stretch(); // into rows_; false: the end
  // Of the sample number of the first row of rows_ after the last one before it; notes what the
  // next one must follow.
  [[nodiscard]] Expected<void> check_numbers();
  [[nodiscard]] SampleBlock next_piece(std::size_t samples); // of the block that is read now
  [[nodiscard]] tl::unexpected<Error> malformed(std::size_t line, const std::string& problem) const;

  FileSettings settings_;
  MappedFile file_;
  std::string_view rest_; // not yet given to a thread
  CsvLayout layout_;
  SourceDescription description_;
  std::deque<Stretch> ahead_; // their threads read file_ and layout_: they end before these go
  CsvRows rows_;
  std::size_t bytes_of_rows_ = 0;
  std::size_t bytes_behind_ = 0; // of stretches before rows_
  std::size_t block_ = 0;        // of rows_: read now
  std::size_t taken_ = 0;        // rows of that block
  std::size_t first_line_ = 2;   // of rows_ in the file
  std::uint64_t next_sample_ = 0;
  StampOrder order_;
  std::optional<std::uint64_t> last_sample_;
};

} // namespace dyncal::drivers::files
