// From the bytes of a frame to the signals that its message declares.
//
// The raw bits are kept beside every value: value = raw * factor + offset in double, raw read as
// the signal's type demands. Reading never goes beyond the frame: a signal for which the frame is
// too short is `truncated`. In J1939 messages the raw values that the standard (J1939-71, tables 1
// and 2) sets aside for "error" and "not available" give no value. Pure functions; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/can/dbc/dbc.hpp"

namespace dyncal::drivers::can {

enum class SignalState {
  valid,
  absent,        // multiplexed, and the switch says that it is not in this frame
  truncated,     // the frame ends before it, or the signal is wider than 64 bits
  not_available, // J1939
  error          // J1939
};

struct DecodedSignal {
  SignalState state = SignalState::absent;
  std::uint64_t raw_bits = 0; // as in the frame, right-aligned
  double value = 0.0;         // NaN unless valid
};

// The bits of the signal, or nothing when the data ends before it.
[[nodiscard]] std::optional<std::uint64_t> raw_bits(const DbcSignal& signal,
                                                    std::span<const std::uint8_t> data);

// The raw number that the bits mean, before factor and offset.
[[nodiscard]] double raw_number(const DbcSignal& signal, std::uint64_t bits);
// The same for integers without loss. REQUIRES: type is an integer.
[[nodiscard]] std::int64_t raw_integer(const DbcSignal& signal, std::uint64_t bits);

[[nodiscard]] DecodedSignal decode_signal(const DbcMessage& message, const DbcSignal& signal,
                                          std::span<const std::uint8_t> data);

// One entry per signal of the message, in its order.
void decode_message(const DbcMessage& message, std::span<const std::uint8_t> data,
                    std::vector<DecodedSignal>& signals);

} // namespace dyncal::drivers::can
