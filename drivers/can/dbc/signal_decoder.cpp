#include "drivers/can/dbc/signal_decoder.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace dyncal::drivers::can {

namespace {

std::optional<std::uint64_t> intel_bits(const DbcSignal& signal,
                                        std::span<const std::uint8_t> data) {
  if (std::size_t{signal.start_bit} + signal.length_bits > data.size() * 8) {
    return std::nullopt;
  }
  std::uint64_t bits = 0;
  for (unsigned taken = 0; taken < signal.length_bits;) {
    const unsigned at = signal.start_bit + taken;
    const unsigned width = std::min(8 - at % 8, signal.length_bits - taken);
    const std::uint64_t part = (data[at / 8] >> (at % 8)) & ((1U << width) - 1U);
    bits |= part << taken;
    taken += width;
  }
  return bits;
}

// From the most significant bit down to bit 0 of its byte, then on with bit 7 of the next byte.
std::optional<std::uint64_t> motorola_bits(const DbcSignal& signal,
                                           std::span<const std::uint8_t> data) {
  const std::size_t before_first =
      std::size_t{signal.start_bit} / 8 * 8 + (7 - signal.start_bit % 8);
  if (before_first + signal.length_bits > data.size() * 8) {
    return std::nullopt;
  }
  std::uint64_t bits = 0;
  std::size_t byte = signal.start_bit / 8;
  unsigned top = signal.start_bit % 8;
  for (unsigned left = signal.length_bits; left > 0; ++byte, top = 7) {
    const unsigned width = std::min(top + 1, left);
    const std::uint64_t part = (data[byte] >> (top + 1 - width)) & ((1U << width) - 1U);
    bits = (bits << width) | part;
    left -= width;
  }
  return bits;
}

bool switched_in(const DbcMessage& message, const DbcSignal& signal,
                 std::span<const std::uint8_t> data) {
  const DbcSignal* at = &signal;
  while (at->multiplexing) { // ends: the parser refuses circles
    const DbcSignal& switch_signal = message.signals[at->multiplexing->switch_signal];
    const auto bits = raw_bits(switch_signal, data);
    const auto& ranges = at->multiplexing->ranges;
    const bool in = bits && std::any_of(ranges.begin(), ranges.end(), [&](const auto& range) {
                      return range.first <= *bits && *bits <= range.second;
                    });
    if (!in) {
      return false;
    }
    at = &switch_signal;
  }
  return true;
}

// Whole bytes: the top byte 0xFF is "not available", 0xFE "error"; fields of two bits: 3 and 2.
// Other widths have no such values.
SignalState j1939_state(const DbcSignal& signal, std::uint64_t bits) {
  if (signal.is_switch || signal.type == RawType::float32 || signal.type == RawType::float64) {
    return SignalState::valid;
  }
  std::uint64_t indicator = 0;
  if (signal.length_bits == 2) {
    indicator = 0xFC | bits; // 3 -> 0xFF, 2 -> 0xFE
  } else if (signal.length_bits == 8 || signal.length_bits == 16 || signal.length_bits == 24 ||
             signal.length_bits == 32) {
    indicator = bits >> (signal.length_bits - 8);
  }
  if (indicator == 0xFF) {
    return SignalState::not_available;
  }
  return indicator == 0xFE ? SignalState::error : SignalState::valid;
}

} // namespace

std::optional<std::uint64_t> raw_bits(const DbcSignal& signal, std::span<const std::uint8_t> data) {
  if (signal.length_bits == 0 || signal.length_bits > 64) {
    return std::nullopt;
  }
  return signal.order == ByteOrder::intel ? intel_bits(signal, data) : motorola_bits(signal, data);
}

std::int64_t raw_integer(const DbcSignal& signal, std::uint64_t bits) {
  if (signal.type != RawType::signed_integer) {
    return static_cast<std::int64_t>(bits);
  }
  const unsigned unused = 64 - signal.length_bits;
  return static_cast<std::int64_t>(bits << unused) >> unused;
}

double raw_number(const DbcSignal& signal, std::uint64_t bits) {
  switch (signal.type) {
  case RawType::float32:
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  case RawType::float64:
    return std::bit_cast<double>(bits);
  case RawType::signed_integer:
    return static_cast<double>(raw_integer(signal, bits));
  case RawType::unsigned_integer:
    return static_cast<double>(bits);
  }
  return 0.0;
}

DecodedSignal decode_signal(const DbcMessage& message, const DbcSignal& signal,
                            std::span<const std::uint8_t> data) {
  DecodedSignal decoded;
  decoded.value = std::numeric_limits<double>::quiet_NaN();
  if (!switched_in(message, signal, data)) {
    return decoded;
  }
  const auto bits = raw_bits(signal, data);
  if (!bits) {
    decoded.state = SignalState::truncated;
    return decoded;
  }
  decoded.raw_bits = *bits;
  decoded.state =
      message.format == FrameFormat::j1939 ? j1939_state(signal, *bits) : SignalState::valid;
  if (decoded.state == SignalState::valid) {
    decoded.value = raw_number(signal, *bits) * signal.factor + signal.offset;
  }
  return decoded;
}

void decode_message(const DbcMessage& message, std::span<const std::uint8_t> data,
                    std::vector<DecodedSignal>& signals) {
  signals.clear();
  for (const DbcSignal& signal : message.signals) {
    signals.push_back(decode_signal(message, signal, data));
  }
}

} // namespace dyncal::drivers::can
