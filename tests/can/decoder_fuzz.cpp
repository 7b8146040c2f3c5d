// Any signal layout on any payload: the bits read are those that a bit-by-bit reading gives, and
// nothing beyond the payload is touched. Input: start bit (2 bytes), length, flags (order, type),
// then the payload.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "drivers/can/dbc/signal_decoder.hpp"

using namespace dyncal::drivers::can;

namespace {

std::optional<std::uint64_t> bit_by_bit(const DbcSignal& signal,
                                        const std::vector<std::uint8_t>& payload) {
  if (signal.length_bits == 0 || signal.length_bits > 64) {
    return std::nullopt;
  }
  std::uint64_t bits = 0;
  std::size_t at = signal.start_bit;
  for (unsigned i = 0; i < signal.length_bits; ++i) {
    if (at / 8 >= payload.size()) {
      return std::nullopt;
    }
    const std::uint64_t bit = payload[at / 8] >> (at % 8) & 1U;
    if (signal.order == ByteOrder::intel) {
      bits |= bit << i;
      ++at;
    } else {
      bits = bits << 1U | bit;
      at = at % 8 == 0 ? at + 15 : at - 1;
    }
  }
  return bits;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) {
    return 0;
  }
  DbcSignal signal;
  signal.start_bit = static_cast<unsigned>(data[0] | (data[1] & 1U) << 8U);
  signal.length_bits = data[2] % 66U;
  signal.order = (data[3] & 1U) != 0 ? ByteOrder::intel : ByteOrder::motorola;
  signal.type = static_cast<RawType>(data[3] >> 1U & 3U);
  if (signal.type == RawType::float32) {
    signal.length_bits = 32;
  }
  if (signal.type == RawType::float64) {
    signal.length_bits = 64;
  }
  const std::vector<std::uint8_t> payload(data + 4, data + std::min<std::size_t>(size, 68));
  DbcMessage message;
  message.format = (data[3] & 8U) != 0 ? FrameFormat::j1939 : FrameFormat::standard;
  message.signals.push_back(signal);
  const auto expected = bit_by_bit(signal, payload);
  const DecodedSignal decoded = decode_signal(message, signal, payload);
  if (raw_bits(signal, payload) != expected ||
      (decoded.state == SignalState::truncated) != !expected ||
      decoded.raw_bits != expected.value_or(0)) {
    std::abort();
  }
  return 0;
}
