// What of a DBC file makes up the samples of one sensor: its messages, the columns of its blocks,
// counter and time field.
//
// Made once from the settings, then read only; the DBC file must outlive it. Fails:
// invalid_setting, with one sentence, when a message or signal does not exist, a unit is not known,
// samples of several messages have nothing to be joined by, or a time source lacks what it needs.
// Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/can/dbc/dbc.hpp"
#include "drivers/can/stream_settings.hpp"
#include "drivers/error.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::can {

struct ChannelLayout {
  std::size_t message = 0; // index into SensorLayout::messages
  std::size_t signal = 0;  // index into DbcMessage::signals
  double unit_factor = 1.0;
  ChannelDescription description;
};

struct SensorLayout {
  std::vector<const DbcMessage*> messages;
  std::vector<ChannelLayout> channels;
  // One a message, or empty: what the frames of a sample are joined and numbered by.
  std::vector<const DbcSignal*> keys;
  bool key_is_time = false;
  double key_tick_s = 0.0;      // s per raw step of the key; 0: not known
  double key_rate_hz = 0.0;     // raw steps per second
  double nominal_rate_hz = 0.0; // of the samples
};

[[nodiscard]] Expected<SensorLayout> lay_out(const StreamSettings& settings, const DbcFile& dbc);

} // namespace dyncal::drivers::can
