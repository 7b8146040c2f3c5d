#include "drivers/interferometer/pair_recording.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>

namespace dyncal::drivers::interferometer {
namespace {

constexpr std::size_t header_bytes = 128; // a multiple of 64, with room for any number of pairs
constexpr std::uint64_t pairs_between_headers = std::uint64_t{1} << 20U;

bool fits_int16(const ChannelDescription& channel) {
  return channel.resolution > 0.0 && channel.maximum > channel.minimum &&
         channel.minimum / channel.resolution > -32768.5 &&
         channel.maximum / channel.resolution < 32767.5;
}

std::string time_text(std::int64_t utc_ns) {
  const std::time_t seconds = utc_ns / 1'000'000'000;
  std::tm parts{};
  std::array<char, 32> text{};
  gmtime_r(&seconds, &parts);
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &parts);
  return {text.data(), length};
}

std::string header_of(bool is_counts, std::uint64_t pairs) {
  std::string text = std::string("{'descr': '") + (is_counts ? "<i2" : "<f4") +
                     "', 'fortran_order': False, 'shape': (" + std::to_string(pairs) + ", 2), }";
  constexpr std::string_view magic{"\x93NUMPY\x01\x00", 8};
  constexpr std::size_t before_text = magic.size() + 2;
  text.resize(header_bytes - before_text - 1, ' ');
  const auto length = static_cast<std::uint16_t>(header_bytes - before_text);
  std::string header(magic);
  header.push_back(static_cast<char>(length & 0xFFU));
  header.push_back(static_cast<char>(length >> 8U));
  return header + text + '\n';
}

template <class Number>
void append(Number value, std::vector<char>& bytes) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(Number));
  std::memcpy(&bytes[at], &value, sizeof(Number));
}

std::int16_t counts_of(double value, double count) {
  constexpr double most = std::numeric_limits<std::int16_t>::max();
  const double counts = std::round(value / count);
  return static_cast<std::int16_t>(std::isfinite(counts) ? std::clamp(counts, -most - 1.0, most)
                                                         : -most - 1.0);
}

} // namespace

PairRecording::PairRecording(std::filesystem::path folder, const ChannelDescription& u1,
                             const ChannelDescription& u2, double rate_hz)
    : folder_(std::move(folder)), unit_(u1.unit), is_counts_(fits_int16(u1) && fits_int16(u2)),
      rate_hz_(rate_hz) {
  if (is_counts_) {
    count_1_ = u1.resolution;
    count_2_ = u2.resolution;
  }
}

PairRecording::~PairRecording() {
  close();
}

Expected<void> PairRecording::failed() {
  ended_ = true;
  file_.close();
  return fail(ErrorCode::refused, path_.string() +
                                      ": the raw signals of the interferometer cannot be written "
                                      "any more; is there room, and may the program write there? "
                                      "Recording of them has ended");
}

Expected<void> PairRecording::open(const SampleBlock& block) {
  std::error_code problem;
  std::filesystem::create_directories(folder_, problem);
  path_ = folder_ /
          (time_text(block.received_utc_ns) + "-" + std::to_string(block.first_sample) + ".npy");
  const std::int64_t stamp_ns =
      block.clock ? block.clock->stamp_ns(block.first_sample) : block.stamps_ns.front();
  std::ofstream about(std::filesystem::path(path_).replace_extension(".toml"));
  about.precision(17);
  about << "rate_hz = " << rate_hz_ << "\nfirst_stamp_ns = " << stamp_ns << "\nunit = '" << unit_
        << "'\nu1_per_count = " << count_1_ << "\nu2_per_count = " << count_2_ << "\n";
  file_.open(path_, std::ios::binary | std::ios::trunc);
  pairs_ = 0;
  write_header();
  return file_ && about.flush() ? Expected<void>{} : failed();
}

void PairRecording::write_header() {
  const std::string header = header_of(is_counts_, pairs_);
  file_.seekp(0);
  file_.write(header.data(), static_cast<std::streamsize>(header.size()));
  file_.seekp(0, std::ios::end);
  stated_pairs_ = pairs_;
}

void PairRecording::close() {
  if (file_.is_open()) {
    write_header();
    file_.close();
  }
  next_.reset();
}

Expected<void> PairRecording::add(const SampleBlock& block, std::span<const double> u1,
                                  std::span<const double> u2) {
  if (ended_ || u1.empty()) {
    return {};
  }
  if (next_ != block.first_sample) {
    close();
    DYNCAL_TRY(open(block));
  }
  next_ = block.first_sample + block.samples;
  bytes_.clear();
  for (std::size_t i = 0; i < u1.size(); ++i) {
    if (is_counts_) {
      append(counts_of(u1[i], count_1_), bytes_);
      append(counts_of(u2[i], count_2_), bytes_);
    } else {
      append(static_cast<float>(u1[i]), bytes_);
      append(static_cast<float>(u2[i]), bytes_);
    }
  }
  file_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  pairs_ += u1.size();
  if (pairs_ - stated_pairs_ >= pairs_between_headers) {
    write_header();
  }
  return file_ ? Expected<void>{} : failed();
}

} // namespace dyncal::drivers::interferometer
