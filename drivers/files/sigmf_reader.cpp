#include "drivers/files/sigmf_reader.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/files/file_channels.hpp"
#include "drivers/files/tdms/tdms_clock.hpp"

namespace dyncal::drivers::files {

Expected<std::unique_ptr<SigmfReader>> SigmfReader::open(const FileSettings& settings) {
  std::filesystem::path meta_path = settings.path;
  std::filesystem::path data_path = settings.path;
  meta_path.replace_extension(".sigmf-meta");
  data_path.replace_extension(".sigmf-data");
  DYNCAL_TRY(auto data, MappedFile::open(data_path));
  std::unique_ptr<SigmfReader> reader(new SigmfReader(meta_path.string(), std::move(data)));
  DYNCAL_TRY(reader->read_meta(settings));
  DYNCAL_TRY(reader->place_captures());
  DYNCAL_TRY(reader->describe(settings));
  return reader;
}

tl::unexpected<Error> SigmfReader::malformed(const std::string& problem) const {
  return fail(ErrorCode::malformed, meta_path_ + ": " + problem);
}

std::uint64_t SigmfReader::numbers_in_sample() const {
  return meta_.channels * (meta_.is_complex ? 2 : 1);
}

Expected<void> SigmfReader::read_meta(const FileSettings& settings) {
  DYNCAL_TRY(const auto file, MappedFile::open(meta_path_));
  auto meta = SigmfMeta::of(file.text());
  if (!meta) {
    return malformed(meta.error());
  }
  meta_ = std::move(*meta);
  const auto rate = settings.sample_rate   ? settings.sample_rate
                    : meta_.sample_rate_hz ? sample_rate_from_hz(*meta_.sample_rate_hz)
                                           : std::nullopt;
  if (!rate) {
    return fail(ErrorCode::invalid_setting,
                meta_path_ + ": core:sample_rate is not there, or no rate from 1e-6 to 1e9 Hz with "
                             "at most nine decimals; state it as sample_rate_hz of the source");
  }
  rate_ = *rate;
  return {};
}

Expected<void> SigmfReader::place_captures() {
  const std::uint64_t size = *size_of(meta_.type);
  const std::uint64_t sample_bytes = size * numbers_in_sample();
  const auto numbers = sigmf_numbers(meta_, rate_);
  if (!numbers) {
    return malformed(numbers.error());
  }
  const std::uint64_t file_bytes = data_.text().size();
  const std::uint64_t end = file_bytes - std::min(meta_.trailing_bytes, file_bytes);
  std::vector<std::vector<ValueStretch>> stretches(numbers_in_sample());
  std::uint64_t headers = 0;
  for (std::size_t i = 0; i < meta_.captures.size(); ++i) {
    const SigmfCapture& capture = meta_.captures[i];
    headers += capture.header_bytes;
    const std::uint64_t place = headers + capture.start * sample_bytes;
    const bool is_last = i + 1 == meta_.captures.size();
    const std::uint64_t bytes = is_last
                                    ? end - std::min(place, end)
                                    : (meta_.captures[i + 1].start - capture.start) * sample_bytes;
    if (place > end || bytes > end - place || bytes % sample_bytes != 0) {
      return malformed("capture " + std::to_string(i) + " needs samples of " +
                       std::to_string(sample_bytes) + " bytes from byte " + std::to_string(place) +
                       " on, but the data file ends at byte " + std::to_string(end) +
                       ", not behind a whole one; it is cut, or of another recording");
    }
    const std::uint64_t samples = bytes / sample_bytes;
    for (std::size_t column = 0; samples > 0 && column < stretches.size(); ++column) {
      stretches[column].push_back({.type = meta_.type,
                                   .big_endian = meta_.big_endian,
                                   .place = place + column * size,
                                   .stride = sample_bytes,
                                   .values = samples});
    }
    if (samples > 0) {
      runs_.push_back({(*numbers)[i], samples});
    }
    all_samples_ += samples;
  }
  for (auto& of_column : stretches) {
    columns_.emplace_back(data_.text(), std::move(of_column));
  }
  clock_ = rate_.clock(meta_.captures.front().unix_ns.value_or(0));
  return runs_.empty() || holds_stamps(clock_, runs_.back().number + runs_.back().samples)
             ? Expected<void>()
             : malformed("its last samples have times beyond the year 2262");
}

Expected<void> SigmfReader::describe(const FileSettings& settings) {
  std::vector<std::string> names;
  for (std::uint64_t channel = 1; channel <= meta_.channels; ++channel) {
    const std::string number = meta_.channels == 1 ? "" : "_" + std::to_string(channel);
    if (meta_.is_complex) {
      names.insert(names.end(), {"i" + number, "q" + number});
    } else {
      names.push_back("channel_" + std::to_string(channel));
    }
  }
  DYNCAL_TRY(description_, describe_file_channels(settings, names));
  description_.nominal_rate_hz = rate_.hz();
  if (!meta_.hardware.empty()) {
    description_.device = meta_.hardware;
  }
  const bool is_float = meta_.type == TdmsType::f32 || meta_.type == TdmsType::f64;
  const bool is_signed =
      meta_.type == TdmsType::i8 || meta_.type == TdmsType::i16 || meta_.type == TdmsType::i32;
  const double values = std::ldexp(1.0, 8 * static_cast<int>(*size_of(meta_.type)));
  for (ChannelDescription& channel : description_.channels) {
    if (!is_float) { // floating-point numbers have no full scale
      channel.minimum = is_signed ? -values / 2.0 : 0.0;
      channel.maximum = channel.minimum + values - 1.0;
      channel.resolution = 1.0;
    }
  }
  return {};
}

double SigmfReader::share_read() const {
  return all_samples_ == 0 ? 1.0
                           : static_cast<double>(samples_read_) / static_cast<double>(all_samples_);
}

Expected<SampleBlock> SigmfReader::read(std::size_t samples) {
  SampleBlock block;
  if (run_ == runs_.size()) {
    return block;
  }
  const Run& run = runs_[run_];
  block.first_sample = run.number + sample_;
  block.samples = static_cast<std::size_t>(std::min<std::uint64_t>(samples, run.samples - sample_));
  block.clock = clock_;
  block.values.resize(block.samples * columns_.size());
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    columns_[i].read({block.values.data() + i * block.samples, block.samples});
  }
  sample_ += block.samples;
  samples_read_ += block.samples;
  if (sample_ == run.samples) {
    ++run_;
    sample_ = 0;
  }
  return block;
}

} // namespace dyncal::drivers::files
