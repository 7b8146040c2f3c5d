// Reads the samples of a WAV file through libsndfile: integers of 8 to 32 bits, whose values are
// -1..1 of full scale, or floating-point numbers, which have none and are taken as they are. What
// codecs make of sound (MP3, ADPCM, A-law ...) are not the values that were measured: refused.
#pragma once

#include <memory>
#include <vector>

#include "drivers/files/file_source.hpp"

struct sf_private_tag;

namespace dyncal::drivers::files {

class WavReader : public SampleReader {
public:
  // Fails (not_found) when there is no such file or channel, (malformed) when libsndfile cannot
  // read it, or a codec has changed its values.
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
