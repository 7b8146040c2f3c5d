#include "drivers/virtual_bench/wire/waveform_memory.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

namespace dyncal::drivers::virtual_bench {
namespace {

using Complex = std::complex<double>;

constexpr std::string_view of_packet = "VOLATILE,";
constexpr double smallest_rel = 1e-4; // of the largest line
constexpr double half_range = 8191.5;
constexpr unsigned largest_code = 0x3FFF;

struct Block {
  std::size_t first = 0; // of its bytes, behind '#'
  std::size_t bytes = 0;
};

// Of definite length, whose '#' is here; nothing where its head has not all come, or is none.
std::optional<Block> block_at(std::string_view text, std::size_t sign) {
  const std::size_t digits =
      sign + 1 < text.size() ? static_cast<std::size_t>(text[sign + 1] - '0') : 0;
  if (digits < 1 || digits > 9 || sign + 2 + digits > text.size()) {
    return std::nullopt;
  }
  Block block{sign + 2 + digits, 0};
  const char* begin = text.data() + sign + 2;
  const auto [end, status] = std::from_chars(begin, begin + digits, block.bytes);
  return status == std::errc() && end == begin + digits ? std::optional(block) : std::nullopt;
}

// Of every `stride`-th point from `first` on; by halves as long as their number is even.
std::vector<Complex> transform(const std::vector<double>& values, std::size_t first,
                               std::size_t stride) {
  const std::size_t n = values.size() / stride;
  std::vector<Complex> spectrum(n);
  const auto turn = [&](std::size_t k) {
    return std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k % n) /
                               static_cast<double>(n));
  };
  if (n % 2 == 1) {
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        spectrum[k] += values[first + i * stride] * turn(k * i);
      }
    }
    return spectrum;
  }
  const auto even = transform(values, first, 2 * stride);
  const auto odd = transform(values, first + stride, 2 * stride);
  for (std::size_t k = 0; k < n / 2; ++k) {
    const Complex turned = turn(k) * odd[k];
    spectrum[k] = even[k] + turned;
    spectrum[k + n / 2] = even[k] - turned;
  }
  return spectrum;
}

} // namespace

bool WaveformMemory::take(std::string_view packet) {
  const std::size_t sign = packet.find('#');
  if (!packet.starts_with(of_packet) || sign == std::string_view::npos) {
    return false;
  }
  const std::string_view order = packet.substr(of_packet.size(), sign - of_packet.size());
  const auto block = block_at(packet, sign);
  if ((order != "CON," && order != "END,") || !block || block->bytes % 2 != 0 ||
      block->bytes / 2 > max_packet_points || packet.size() < block->first + block->bytes) {
    return false;
  }
  std::vector<std::uint16_t> codes;
  for (std::size_t i = 0; i < block->bytes; i += 2) {
    const auto low = static_cast<unsigned char>(packet[block->first + i]);
    const auto high = static_cast<unsigned char>(packet[block->first + i + 1]);
    codes.push_back(static_cast<std::uint16_t>(low | high << 8U));
  }
  const std::size_t before = is_complete_ ? 0 : codes_.size();
  if (before + codes.size() > max_points ||
      std::ranges::any_of(codes, [](unsigned code) { return code > largest_code; })) {
    return false;
  }
  codes_.resize(before);
  codes_.insert(codes_.end(), codes.begin(), codes.end());
  is_complete_ = order == "END," && !codes_.empty();
  return true;
}

std::vector<DriveLine> WaveformMemory::lines() const {
  std::vector<double> values;
  std::ranges::transform(codes_, std::back_inserter(values),
                         [](double code) { return code / half_range - 1.0; });
  const std::vector<Complex> spectrum = transform(values, 0, 1);
  const double n = static_cast<double>(spectrum.size());
  std::vector<DriveLine> all;
  double largest = 0.0;
  for (std::size_t k = 1; 2 * k < spectrum.size(); ++k) {
    const Complex phasor = 2.0 / n * Complex(0.0, 1.0) * spectrum[k];
    all.push_back({rate_hz_ * static_cast<double>(k) / n, std::abs(phasor), std::arg(phasor)});
    largest = std::max(largest, all.back().amplitude_v);
  }
  std::erase_if(all,
                [&](const DriveLine& line) { return line.amplitude_v < smallest_rel * largest; });
  return all;
}

std::size_t end_of_line(std::string_view received) {
  std::size_t from = 0;
  for (;;) {
    const std::size_t end = received.find('\n', from);
    const std::size_t sign = received.find('#', from);
    if (sign == std::string_view::npos || end < sign) {
      return end;
    }
    const auto block = block_at(received, sign);
    if (!block) {
      return end; // what follows is no block, or has not come
    }
    from = block->first + block->bytes;
    if (from >= received.size()) {
      return std::string_view::npos;
    }
  }
}

} // namespace dyncal::drivers::virtual_bench
