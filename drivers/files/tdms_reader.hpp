// Reads channels of a TDMS file (LabVIEW, NI-DAQmx) that belong together: all with numbers, those
// of a group, or one; README.md has the format, tdms/ its forms.
//
// The file is mapped into memory. All channels must have as many values, one start and one
// interval. Values are scaled as the file states it. Every error names the file and a segment or
// channel.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/files/file_source.hpp"
#include "drivers/files/mapped_file.hpp"
#include "drivers/files/tdms/strided_values.hpp"
#include "drivers/files/tdms/tdms_layout.hpp"
#include "drivers/files/tdms/tdms_scaling.hpp"

namespace dyncal::drivers::files {

class TdmsReader : public SampleReader {
public:
  // Fails (not_found, malformed, invalid_setting) as every file source does.
  [[nodiscard]] static Expected<std::unique_ptr<TdmsReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override;

private:
  struct Column {
    StridedValues values;
    TdmsScaling scaling;
  };

  TdmsReader(const FileSettings& settings, MappedFile file)
      : settings_(settings), file_(std::move(file)) {}
  [[nodiscard]] Expected<void> choose_channels();
  [[nodiscard]] Expected<void> find_clock();
  [[nodiscard]] Expected<void> check_restarts() const;
  [[nodiscard]] Expected<void> add_columns();
  [[nodiscard]] Expected<std::vector<std::vector<ValueStretch>>>
  stretches_of(const TdmsChannel& channel, const TdmsScaling& scaling) const;
  [[nodiscard]] tl::unexpected<Error> malformed(const std::string& problem) const;
  [[nodiscard]] tl::unexpected<Error> not_equal(const std::string& what, std::size_t channel) const;
  [[nodiscard]] const TdmsChannel& channel(std::size_t chosen) const {
    return layout_.channels[chosen_[chosen]];
  }

  FileSettings settings_;
  MappedFile file_;
  TdmsLayout layout_;
  std::vector<std::size_t> chosen_; // of the layout's channels
  std::vector<Column> columns_;
  RegularClock clock_;
  SourceDescription description_;
  std::uint64_t samples_ = 0;
  std::uint64_t next_sample_ = 0;
};

} // namespace dyncal::drivers::files
