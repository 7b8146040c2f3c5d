#include "drivers/files/wav_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <sndfile.h>
#include <span>
#include <string_view>

#include "drivers/files/file_channels.hpp"

namespace dyncal::drivers::files {
namespace {

// Bits of an integer format, 0 for float. Nothing for what keeps the sound but not the values (MP3,
// Vorbis, Opus, ADPCM, A-law ...), which the library reads under any name.
std::optional<int> bits_of(int format) {
  switch (format & SF_FORMAT_SUBMASK) {
  case SF_FORMAT_PCM_S8:
  case SF_FORMAT_PCM_U8:
    return 8;
  case SF_FORMAT_PCM_16:
    return 16;
  case SF_FORMAT_PCM_24:
    return 24;
  case SF_FORMAT_PCM_32:
    return 32;
  case SF_FORMAT_FLOAT:
  case SF_FORMAT_DOUBLE:
    return 0;
  default:
    return std::nullopt;
  }
}

std::string name_of_subtype(int format) {
  SF_FORMAT_INFO info{};
  info.format = format & SF_FORMAT_SUBMASK;
  const bool known =
      sf_command(nullptr, SFC_GET_FORMAT_INFO, &info, sizeof(info)) == 0 && info.name != nullptr;
  return known ? info.name : "an unknown codec";
}

constexpr const char* wanted_formats = "write integers of 8 to 32 bits or floating-point numbers";
// Of RIFF; what they leave out says in a form of its own what it holds (65534).
constexpr std::array values_as_they_are{1U, 3U, 65534U};

std::uint32_t little_endian(std::span<const unsigned char> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) {
    value = value << 8U | bytes[i - 1];
  }
  return value;
}

// The format of a WAV file that the library does not read; empty where it is none.
std::optional<std::uint32_t> format_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, 12> head{};
  const auto read = [&](std::size_t count) {
    file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(count));
    return static_cast<bool>(file);
  };
  const auto is = [&](std::size_t at, std::string_view name) {
    return std::equal(name.begin(), name.end(), head.begin() + static_cast<std::ptrdiff_t>(at));
  };
  if (!read(12) || !is(0, "RIFF") || !is(8, "WAVE")) {
    return std::nullopt;
  }
  while (read(8)) {
    const std::uint32_t size = little_endian(std::span(head).subspan(4, 4));
    if (is(0, "fmt ")) {
      return read(2) ? std::optional(little_endian(std::span(head).first(2))) : std::nullopt;
    }
    file.seekg(static_cast<std::streamoff>(size) + size % 2, std::ios::cur);
  }
  return std::nullopt;
}

std::string why_not_read(const std::string& path) {
  const auto format = format_of(path);
  const bool as_they_are =
      !format || std::find(values_as_they_are.begin(), values_as_they_are.end(), *format) !=
                     values_as_they_are.end();
  return as_they_are
             ? path + ": cannot be read as WAV (" + sf_strerror(nullptr) + ")"
             : path + ": holds what a codec made of the values (format " + std::to_string(*format) +
                   " of WAV), which cannot be read; " + wanted_formats;
}

} // namespace

void WavReader::Close::operator()(sf_private_tag* file) const {
  sf_close(file);
}

Expected<std::unique_ptr<WavReader>> WavReader::open(const FileSettings& settings) {
  std::unique_ptr<WavReader> reader(new WavReader());
  reader->path_ = settings.path.string();
  if (!std::filesystem::is_regular_file(settings.path)) {
    return fail(ErrorCode::not_found,
                reader->path_ + ": cannot read this file; does it exist, and may you read it?");
  }
  SF_INFO info{};
  reader->file_.reset(sf_open(reader->path_.c_str(), SFM_READ, &info));
  if (!reader->file_) {
    return fail(ErrorCode::malformed, why_not_read(reader->path_));
  }
  const std::optional<int> bits = bits_of(info.format);
  if (!bits) {
    return fail(ErrorCode::malformed, reader->path_ + ": holds " + name_of_subtype(info.format) +
                                          ", which does not keep every value; " + wanted_formats);
  }
  reader->all_samples_ = static_cast<std::uint64_t>(std::max<sf_count_t>(info.frames, 0));
  std::vector<std::string> names;
  for (int channel = 1; channel <= info.channels; ++channel) {
    names.push_back("channel_" + std::to_string(channel));
  }
  DYNCAL_TRY(reader->description_, describe_file_channels(settings, names));
  reader->rate_ = settings.sample_rate.value_or(SampleRate{info.samplerate, 1});
  reader->description_.nominal_rate_hz = reader->rate_.hz();
  for (ChannelDescription& channel : reader->description_.channels) {
    if (*bits > 0) { // floating-point numbers have no full scale
      channel.minimum = -1.0;
      channel.maximum = 1.0;
      channel.resolution = std::ldexp(1.0, 1 - *bits);
    }
  }
  return reader;
}

double WavReader::share_read() const {
  if (at_end_ || all_samples_ == 0) {
    return at_end_ ? 1.0 : 0.0;
  }
  return std::min(1.0, static_cast<double>(next_sample_) / static_cast<double>(all_samples_));
}

Expected<SampleBlock> WavReader::read(std::size_t samples) {
  const std::size_t channels = description_.channels.size();
  frames_.resize(samples * channels);
  const sf_count_t count =
      sf_readf_double(file_.get(), frames_.data(), static_cast<sf_count_t>(samples));
  if (sf_error(file_.get()) != SF_ERR_NO_ERROR) {
    return fail(ErrorCode::malformed, path_ + ": sample " + std::to_string(next_sample_) + ": " +
                                          sf_strerror(file_.get()));
  }
  SampleBlock block;
  block.first_sample = next_sample_;
  block.samples = static_cast<std::size_t>(count);
  block.clock = rate_.clock(0);
  block.values.resize(block.samples * channels);
  for (std::size_t i = 0; i < block.samples; ++i) {
    for (std::size_t channel = 0; channel < channels; ++channel) {
      block.values[channel * block.samples + i] = frames_[i * channels + channel];
    }
  }
  next_sample_ += block.samples;
  at_end_ = block.samples == 0;
  return block;
}

} // namespace dyncal::drivers::files
