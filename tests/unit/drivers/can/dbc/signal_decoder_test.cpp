#include "drivers/can/dbc/signal_decoder.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/can/dbc/signal_unit.hpp"
#include "drivers/can/message_index.hpp"

namespace dyncal::drivers::can {
namespace {

DbcSignal signal(unsigned start, unsigned length, ByteOrder order, RawType type) {
  DbcSignal signal;
  signal.start_bit = start;
  signal.length_bits = length;
  signal.order = order;
  signal.type = type;
  return signal;
}

TEST(SignalDecoder, DecodesARealImuFrameByItsHandMadeSolution) {
  // CANmod.gps, id 9, data FF43104A01FA8F7F: 0.125 m/s^2 and 0.25 deg/s a bit.
  const std::vector<std::uint8_t> data = {0xFF, 0x43, 0x10, 0x4A, 0x01, 0xFA, 0x8F, 0x7F};
  const auto value = [&](unsigned start, unsigned length, double factor, double offset) {
    return static_cast<double>(
               raw_bits(signal(start, length, ByteOrder::intel, RawType::unsigned_integer), data)
                   .value_or(0)) *
               factor +
           offset;
  };
  EXPECT_EQ(value(1, 10, 0.125, -64), -0.125);
  EXPECT_EQ(value(11, 10, 0.125, -64), 1.0);
  EXPECT_EQ(value(21, 10, 0.125, -64), 10.0);
  EXPECT_EQ(value(31, 11, 0.25, -256), 0.5);
  EXPECT_EQ(value(42, 11, 0.25, -256), -0.5);
  EXPECT_EQ(value(53, 11, 0.25, -256), -1.0);
}

TEST(SignalDecoder, ReadsMotorolaAcrossBytesAndToTheEndOfAnFdFrame) {
  std::vector<std::uint8_t> data(64, 0);
  data[62] = 0x0A;
  data[63] = 0xBC;
  // Most significant bit 3 of byte 62, twelve bits.
  EXPECT_EQ(raw_bits(signal(62 * 8 + 3, 12, ByteOrder::motorola, RawType::unsigned_integer), data),
            0xABCU);
  EXPECT_EQ(raw_bits(signal(62 * 8 + 3, 13, ByteOrder::motorola, RawType::unsigned_integer), data),
            std::nullopt);
}

TEST(SignalDecoder, ExtendsTheSignOfEveryWidth) {
  EXPECT_EQ(raw_integer(signal(0, 3, ByteOrder::intel, RawType::signed_integer), 0b100), -4);
  EXPECT_EQ(
      raw_integer(signal(0, 64, ByteOrder::intel, RawType::signed_integer), ~std::uint64_t{0}), -1);
  EXPECT_EQ(
      raw_number(signal(0, 64, ByteOrder::intel, RawType::unsigned_integer), ~std::uint64_t{0}),
      18446744073709551616.0);
}

TEST(SignalDecoder, GivesNoValueWhereTheFrameIsTooShort) {
  DbcMessage message;
  message.signals = {signal(0, 16, ByteOrder::intel, RawType::signed_integer),
                     signal(16, 16, ByteOrder::intel, RawType::signed_integer)};
  std::vector<DecodedSignal> decoded;
  decode_message(message, std::vector<std::uint8_t>{1, 0, 9}, decoded);
  EXPECT_EQ(decoded[0].state, SignalState::valid);
  EXPECT_EQ(decoded[0].value, 1.0);
  EXPECT_EQ(decoded[1].state, SignalState::truncated);
  EXPECT_TRUE(std::isnan(decoded[1].value));
}

TEST(SignalDecoder, TakesJ1939NotAvailableAndErrorForNoValue) {
  DbcMessage message;
  message.format = FrameFormat::j1939;
  message.signals = {signal(0, 16, ByteOrder::intel, RawType::unsigned_integer)};
  const auto state = [&](std::uint8_t low, std::uint8_t high) {
    return decode_signal(message, message.signals[0], std::vector<std::uint8_t>{low, high}).state;
  };
  EXPECT_EQ(state(0x00, 0xFF), SignalState::not_available);
  EXPECT_EQ(state(0x12, 0xFE), SignalState::error);
  EXPECT_EQ(state(0xFF, 0xFA), SignalState::valid);
  message.format = FrameFormat::extended;
  EXPECT_EQ(state(0xFF, 0xFF), SignalState::valid);
}

TEST(MessageIndex, MatchesJ1939ByGroupWithAnyPriorityAndSource) {
  DbcMessage broadcast;
  broadcast.id = 0x18FEF100;
  broadcast.extended = true;
  broadcast.format = FrameFormat::j1939;
  DbcMessage addressed = broadcast;
  addressed.id = 0x18EA0000;
  DbcMessage plain;
  plain.id = 0x123;
  const MessageIndex index({&broadcast, &addressed, &plain});
  const auto found = [&](std::uint32_t id, bool extended) {
    CanFrame frame;
    frame.id = id;
    frame.extended = extended;
    return index.find(frame);
  };
  EXPECT_EQ(found(0x0CFEF12A, true), &broadcast);
  EXPECT_EQ(found(0x0CFEF22A, true), nullptr);
  EXPECT_EQ(found(0x18EAFF21, true), &addressed);
  EXPECT_EQ(found(0x123, false), &plain);
  EXPECT_EQ(found(0x123, true), nullptr);
  CanFrame frame;
  frame.id = 0x0CFEF12A;
  frame.extended = true;
  EXPECT_TRUE(index.filters()[0].passes(frame));
  EXPECT_FALSE(index.filters()[2].passes(frame));
}

TEST(SignalUnit, TranslatesWhatPeopleWriteAndRefusesTheRest) {
  EXPECT_EQ(signal_unit("m/s^2")->d_si, "\\metre\\second\\tothe{-2}");
  EXPECT_EQ(signal_unit("g")->factor, 9.80665);
  EXPECT_EQ(signal_unit("\u00b0/s")->d_si, "\\degree\\second\\tothe{-1}");
  EXPECT_EQ(signal_unit("")->d_si, "\\one");
  EXPECT_FALSE(signal_unit("furlong"));
}

} // namespace
} // namespace dyncal::drivers::can
