// What a bench file says of a recorded series beside the file itself: factors of its channels
// (`scale`), and a number of seconds that is added to its stamps (`time_offset_s`).
//
// A factor changes what the values mean: a channel whose unit the file states needs one of the
// settings as well, or its values would keep a unit that they no longer have. Range and resolution
// are scaled like the values. One thread.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "drivers/files/file_source.hpp"

namespace dyncal::drivers::files {

class AdjustedReader : public SampleReader {
public:
  // `reader` itself where the settings change nothing. Fails (not_found) where they scale a channel
  // that it does not have, (invalid_setting) where its unit is not stated.
  [[nodiscard]] static Expected<std::unique_ptr<SampleReader>>
  open(std::unique_ptr<SampleReader> reader, const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  // Fails (malformed) too where a stamp leaves 64 bits.
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override { return reader_->share_read(); }

private:
  AdjustedReader(std::unique_ptr<SampleReader> reader, const FileSettings& settings)
      : reader_(std::move(reader)), description_(reader_->description()), settings_(settings) {}
  [[nodiscard]] Expected<void> find_channels();
  [[nodiscard]] bool move(std::int64_t& stamp_ns) const;

  std::unique_ptr<SampleReader> reader_;
  SourceDescription description_;
  FileSettings settings_;
  std::vector<std::pair<std::size_t, double>> factors_; // by channel
};

} // namespace dyncal::drivers::files
