// Reads the samples of a SigMF recording: NAME.sigmf-data by what NAME.sigmf-meta says of it
// (sigmf_meta.hpp; README.md has the channels). Either name is taken.
//
// The data are mapped into memory. Values are as they stand in the file: counts of integers, not
// parts of full scale. Gaps between captures are gaps of the sample numbers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/files/file_source.hpp"
#include "drivers/files/mapped_file.hpp"
#include "drivers/files/sigmf_meta.hpp"
#include "drivers/files/tdms/strided_values.hpp"

namespace dyncal::drivers::files {

class SigmfReader : public SampleReader {
public:
  // Fails (not_found, malformed, invalid_setting) as every file source does.
  [[nodiscard]] static Expected<std::unique_ptr<SigmfReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override;

private:
  struct Run {                // samples of one capture
    std::uint64_t number = 0; // of its first
    std::uint64_t samples = 0;
  };

  SigmfReader(std::string meta_path, MappedFile data)
      : meta_path_(std::move(meta_path)), data_(std::move(data)) {}
  [[nodiscard]] Expected<void> read_meta(const FileSettings& settings);
  [[nodiscard]] Expected<void> place_captures();
  [[nodiscard]] Expected<void> describe(const FileSettings& settings);
  [[nodiscard]] std::uint64_t numbers_in_sample() const;
  [[nodiscard]] tl::unexpected<Error> malformed(const std::string& problem) const;

  std::string meta_path_;
  MappedFile data_;
  SigmfMeta meta_;
  SampleRate rate_;
  RegularClock clock_;
  std::vector<Run> runs_;
  std::vector<StridedValues> columns_;
  SourceDescription description_;
  std::size_t run_ = 0;
  std::uint64_t sample_ = 0; // of the run
  std::uint64_t all_samples_ = 0;
  std::uint64_t samples_read_ = 0;
};

} // namespace dyncal::drivers::files
