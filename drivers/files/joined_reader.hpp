// Single channels, of one file or of several, as one series.
//
// Each is read by a reader of its own; sample n of one belongs to sample n of the others. All must
// be as long, have the same sample numbers and, where a file states times, the same stamps to the
// nanosecond: nothing is shifted or resampled. A channel whose times begin at 0, as those of a file
// without any do, takes those of the others. One thread.
#pragma once

#include <memory>
#include <vector>

#include "drivers/files/file_source.hpp"

namespace dyncal::drivers::files {

class JoinedReader : public SampleReader {
public:
  // REQUIRES: settings.single is not empty. Fails as every file source does; (malformed) where
  // channels do not belong together.
  [[nodiscard]] static Expected<std::unique_ptr<SampleReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override { return parts_.front().reader->share_read(); }

private:
  struct Part {
    std::unique_ptr<SampleReader> reader;
    FileChannel channel;
    std::vector<std::size_t> columns{}; // of the reader's
    SampleBlock block{};
    std::size_t used = 0; // samples of the block

    [[nodiscard]] std::size_t left() const { return block.samples - used; }
    [[nodiscard]] std::uint64_t sample() const { return block.first_sample + used; }
    [[nodiscard]] std::int64_t stamp_ns(std::size_t ahead) const;
    [[nodiscard]] bool is_timed() const { return !block.clock || block.clock->origin_ns != 0; }
  };

  explicit JoinedReader(const FileSettings& settings) : settings_(settings) {}
  [[nodiscard]] Expected<Part> open_part(const FileChannel& channel) const;
  [[nodiscard]] Expected<void> describe();
  [[nodiscard]] Expected<void> fill(std::size_t samples);
  [[nodiscard]] Expected<void> compare(const Part& one, const Part& other,
                                       std::size_t samples) const;
  [[nodiscard]] const Part& timed() const;

  FileSettings settings_;
  std::vector<Part> parts_;
  SourceDescription description_;
};

} // namespace dyncal::drivers::files
