#include "drivers/files/npy_reader.hpp"

#include <algorithm>
#include <cstring>

#include "drivers/files/file_channels.hpp"
#include "drivers/files/regular_stamps.hpp"

namespace dyncal::drivers::files {
namespace {

// A field of `rows` rows, one number after the other.
template <class Stored, class Number>
void copy_as(const char* from, std::size_t row_bytes, std::size_t rows, Number* to) {
  for (std::size_t i = 0; i < rows; ++i, from += row_bytes) {
    Stored value;
    std::memcpy(&value, from, sizeof(value));
    to[i] =
        static_cast<Number>(value); // NOLINT(bugprone-signed-char-misuse): int8 is a number here
  }
}

} // namespace

Expected<std::unique_ptr<NpyReader>> NpyReader::open(const FileSettings& settings) {
  DYNCAL_TRY(auto file, MappedFile::open(settings.path));
  std::unique_ptr<NpyReader> reader(new NpyReader(settings, std::move(file)));
  auto header = NpyHeader::of(reader->file_.text());
  if (!header) {
    return reader->malformed(header.error());
  }
  reader->header_ = std::move(*header);
  DYNCAL_TRY(reader->name_fields());
  return reader;
}

tl::unexpected<Error> NpyReader::malformed(const std::string& problem) const {
  return fail(ErrorCode::malformed, settings_.path.string() + ": " + problem);
}

Expected<void> NpyReader::name_fields() {
  std::vector<std::string> names;
  for (const NpyField& field : header_.fields) {
    if (field.kind == 'V') {
      continue;
    }
    if (field.name == "t_ns" || field.name == "sample_number") {
      if (field.kind == 'f') {
        return malformed("the field '" + field.name + "' must hold integers");
      }
      (field.name == "t_ns" ? time_ : number_) = field;
      continue;
    }
    names.push_back(field.name);
    channels_.push_back(field);
  }
  if (!time_ && !settings_.sample_rate) {
    return fail(
        ErrorCode::invalid_setting,
        settings_.path.string() +
            ": no field t_ns, and no sample rate is given (sample_rate_hz of the source in a "
            "bench file, --nominal-rate of a command); one of them must tell the time");
  }
  DYNCAL_TRY(description_, describe_file_channels(settings_, names));
  return {};
}

template <class Number>
void NpyReader::copy(const NpyField& field, std::size_t rows, Number* to) const {
  const char* const from =
      file_.text().data() + header_.header_bytes + row_ * header_.row_bytes + field.place;
  const auto as = [&]<class Stored>(Stored) { copy_as<Stored>(from, header_.row_bytes, rows, to); };
  const bool is_signed = field.kind == 'i';
  if (field.kind == 'f') {
    field.size == 8 ? as(double{}) : as(float{});
  } else if (field.size == 8) {
    is_signed ? as(std::int64_t{}) : as(std::uint64_t{});
  } else if (field.size == 4) {
    is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
  } else if (field.size == 2) {
    is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
  } else {
    is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
  }
}

Expected<void> NpyReader::check_numbers(const std::vector<std::uint64_t>& numbers) const {
  if (!numbers.empty() && row_ > 0 && numbers.front() < next_sample_) {
    return malformed("row " + std::to_string(row_) + ": " +
                     not_rising(numbers.front(), next_sample_ - 1));
  }
  return {};
}

double NpyReader::share_read() const {
  return header_.rows == 0 ? 1.0 : static_cast<double>(row_) / static_cast<double>(header_.rows);
}

Expected<SampleBlock> NpyReader::read(std::size_t samples) {
  SampleBlock block;
  block.samples = std::min(samples, header_.rows - row_);
  if (block.samples == 0) {
    return block;
  }
  std::vector<std::uint64_t> numbers;
  if (number_) {
    numbers.resize(block.samples);
    copy(*number_, block.samples, numbers.data());
    const auto gap = std::adjacent_find(numbers.begin(), numbers.end(),
                                        [](auto a, auto b) { return b != a + 1; });
    block.samples =
        gap == numbers.end() ? block.samples : static_cast<std::size_t>(gap - numbers.begin()) + 1;
  }
  block.first_sample = number_ ? numbers.front() : next_sample_;
  if (time_) {
    block.stamps_ns.resize(block.samples);
    copy(*time_, block.samples, block.stamps_ns.data());
  }
  DYNCAL_TRY(check_numbers(numbers));
  block.values.resize(block.samples * channels_.size());
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    copy(channels_[channel], block.samples, block.values.data() + channel * block.samples);
  }
  row_ += block.samples;
  next_sample_ = block.first_sample + block.samples;
  if (time_) {
    order_.check(block);
    make_regular(block);
  } else {
    block.clock = settings_.sample_rate->clock(0);
  }
  return block;
}

} // namespace dyncal::drivers::files
