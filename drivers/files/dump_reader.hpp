// Reads the ASCII dumps (.dump) of the public SmartUp receiver, a stretch at a time; README.md has
// the format, every error names file and line.
//
// Channels are those that the first line describes, and columns that it does not but the settings
// name (Data_11: the sync ADC of the calibration firmware). The receiver writes 0.0 for what was
// not measured: nothing tells it from a measured 0. Sample numbers count on over the end of 32
// bits. One thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/file_source.hpp"
#include "drivers/files/mapped_file.hpp"
#include "drivers/files/stamp_order.hpp"

namespace dyncal::drivers::files {

class DumpReader : public SampleReader {
public:
  // Fails (not_found, malformed) as every file source does.
  [[nodiscard]] static Expected<std::unique_ptr<DumpReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override;

private:
  struct Row {
    std::uint64_t sensor = 0;
    std::uint64_t number = 0; // unwrapped
    std::int64_t stamp_ns = 0;
    std::uint32_t u_stamp_ns = 0;
    std::vector<double> values; // of the channels
  };

  DumpReader(const FileSettings& settings, MappedFile file)
      : settings_(settings), file_(std::move(file)), rest_(file_.text()) {}
  [[nodiscard]] Expected<void> read_description();
  [[nodiscard]] Expected<void> read_names();
  // Nothing at the end of the file.
  [[nodiscard]] Expected<std::optional<Row>> next_row();
  [[nodiscard]] tl::expected<Row, std::string> parse(std::string_view line) const;
  [[nodiscard]] std::optional<std::string_view> next_line();
  [[nodiscard]] tl::unexpected<Error> malformed(const std::string& problem) const;

  FileSettings settings_;
  MappedFile file_;
  std::string_view rest_;
  std::size_t line_ = 0; // the last one that was taken
  SourceDescription description_;
  std::vector<std::size_t> columns_; // of the channels, Data_01 is 0
  std::optional<std::uint64_t> sensor_;
  std::optional<std::uint64_t> last_sample_; // unwrapped
  std::optional<Row> waiting_;               // begins the next block
  StampOrder order_;
};

} // namespace dyncal::drivers::files
