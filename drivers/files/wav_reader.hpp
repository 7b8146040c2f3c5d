// Reads the samples of a WAV file (16, 24, 32 bit or float) through libsndfile; values are -1..1 of
// full scale.
#pragma once

#include <memory>
#include <vector>

#include "drivers/files/file_source.hpp"

struct sf_private_tag;

namespace dyncal::drivers::files {

class WavReader : public SampleReader {
public:
  // Fails (not_found) when there is no such file or channel, (malformed) when libsndfile cannot
  // read it.
  [[nodiscard]] static Expected<std::unique_ptr<WavReader>> open(const FileSettings& settings);

  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] Expected<SampleBlock> read(std::size_t samples) override;
  [[nodiscard]] double share_read() const override;

private:
  struct Close {
    void operator()(sf_private_tag* file) const;
  };
  WavReader() = default;

  std::unique_ptr<sf_private_tag, Close> file_;
  std::string path_;
  SampleRate rate_;
  SourceDescription description_;
  std::uint64_t all_samples_ = 0; // as the header has it
  std::uint64_t next_sample_ = 0;
  bool at_end_ = false;
  std::vector<double> frames_;
};

} // namespace dyncal::drivers::files
