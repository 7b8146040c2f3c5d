#include "drivers/can/time/frame_duration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::drivers::can {
namespace {

struct Expected {
  std::uint32_t id;
  bool extended;
  bool fd;
  bool bit_rate_switch;
  bool error_state_indicator;
  bool remote;
  std::string_view data;
  FrameBits bits;
};

CanFrame frame_of(const Expected& expected) {
  CanFrame frame;
  frame.id = expected.id;
  frame.extended = expected.extended;
  frame.fd = expected.fd;
  frame.bit_rate_switch = expected.bit_rate_switch;
  frame.error_state_indicator = expected.error_state_indicator;
  frame.remote = expected.remote;
  frame.length = static_cast<std::uint8_t>(expected.data.size() / 2);
  for (std::size_t i = 0; i < frame.length; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(
        std::stoul(std::string(expected.data.substr(2 * i, 2)), nullptr, 16));
  }
  return frame;
}

// From an implementation of its own that writes the frame out bit for bit, looks at every five bits
// of the stuffed stream and inserts the sixth.
const std::vector<Expected> reference = {
    {0x123, false, false, false, false, false, "0000000000000000", {122, 0, 14}},
    {0x0, false, false, false, false, false, "", {50, 0, 6}},
    {0x7ff, false, false, false, false, false, "ffffffffffffffff", {123, 0, 15}},
    {0x555, false, false, false, false, false, "5555555555555555", {109, 0, 1}},
    {0x0, true, false, false, false, false, "0000000000000000", {147, 0, 19}},
    {0x1fffffff, true, false, false, false, false, "ffffffffffffffff", {146, 0, 18}},
    {0x73c, false, false, false, false, false, "ff00f300ff0015ff", {118, 0, 10}},
    {0xa146219, true, false, false, false, false, "", {65, 0, 1}},
    {0x102, false, false, false, false, false, "", {48, 0, 4}},
    {0x2482299, true, false, false, false, false, "7bffff", {92, 0, 4}},
    {0x320, false, false, false, false, false, "77ff02ffff2aff75", {118, 0, 10}},
    {0x127fa16c, true, false, false, false, false, "", {68, 0, 4}},
    {0x123, false, false, false, false, true, "0000", {44, 0, 0}},
    {0x0, false, true, false, false, false, "", {62, 0, 9}},
    {0x0, true, true, true, true, false, "ff", {50, 42, 12}},
    {0x0, false, true, true, false, false, "0000ffff2565ffff", {28, 106, 17}},
    {0x0, true, true, false, false, false, "000000ff00ff61ff00ff008a", {190, 0, 22}},
    {0x0, false, true, true, false, false, "00c90000ff04ff00006a00ff00f7ff5d", {28, 176, 23}},
    {0x9dd5a64,
     true,
     true,
     true,
     true,
     false,
     "747f0064ffff000000ffd7ff5900ffff0000ff00",
     {46, 220, 30}},
    {0x0,
     false,
     true,
     false,
     false,
     false,
     "ffbc0000ff4700ff000aff22ff00ffbc16ff000000ff07ff",
     {281, 0, 32}},
    {0x0,
     true,
     true,
     true,
     false,
     false,
     "00ffd5ffffec2affff00ffffff0067ffffffcf0000ff700000ff14ff00ff00ff",
     {50, 329, 47}},
    {0x7e6,
     false,
     true,
     true,
     false,
     false,
     "ff008e158fff09ff00ff0018ff370000ff5bff00ffb1ff00d200ff64ffffa70000ffffffff00ffff00000058abff4"
     "cff",
     {27, 468, 54}},
    {0x0,
     true,
     true,
     false,
     true,
     false,
     "e09454ffc3ff488b00d23a020016cdff2f00ffffff00fff300ffff42000000ff0000ff3e806500c0d351686f6e000"
     "0a100000000ff00ff00ce0066ff3baf0000",
     {657, 0, 69}},
    {0x123, false, true, true, false, false, "0101010101010101010101010101011f", {26, 176, 21}},
    {0x123,
     false,
     true,
     true,
     false,
     false,
     "000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000000"
     "00000000000000000000000000000000000",
     {26, 652, 109}},
};

TEST(FrameDuration, CountsEveryBitOfTheFrameAsABitByBitReferenceDoes) {
  for (const Expected& expected : reference) {
    const FrameBits bits = frame_bits(frame_of(expected));
    SCOPED_TRACE(std::string(expected.data) + " id " + std::to_string(expected.id));
    EXPECT_EQ(bits.nominal, expected.bits.nominal);
    EXPECT_EQ(bits.data, expected.bits.data);
    EXPECT_EQ(bits.stuff, expected.bits.stuff);
  }
}

TEST(FrameDuration, IsBitsOverRateOfEachPhase) {
  CanFrame frame = frame_of(reference.front());
  const double bits = frame_bits(frame).nominal;
  EXPECT_DOUBLE_EQ(frame_duration_s(frame, {500e3, 0.0}), bits / 500e3);
  frame.fd = frame.bit_rate_switch = true;
  const FrameBits fd = frame_bits(frame);
  EXPECT_DOUBLE_EQ(frame_duration_s(frame, {1e6, 5e6}), fd.nominal / 1e6 + fd.data / 5e6);
}

TEST(FrameDuration, OfNoFrameExceedsTheLongestThereIs) {
  for (const Expected& expected : reference) {
    const CanFrame frame = frame_of(expected);
    EXPECT_LE(frame_duration_s(frame, {1e6, 5e6}),
              max_frame_s(frame.fd, frame.bit_rate_switch, frame.length, {1e6, 5e6}));
  }
}

} // namespace
} // namespace dyncal::drivers::can
