#include "drivers/can/sensor_layout.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/can/dbc/signal_unit.hpp"

namespace dyncal::drivers::can {

namespace {

tl::unexpected<Error> refused(std::string message) {
  return fail(ErrorCode::invalid_setting, std::move(message));
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < 20; ++i) {
    text += (i > 0 ? ", " : "") + names[i];
  }
  return text;
}

std::string message_names(const DbcFile& dbc) {
  std::vector<std::string> names;
  for (const DbcMessage& message : dbc.messages) {
    names.push_back(message.name);
  }
  return listed(names);
}

Expected<std::vector<const DbcMessage*>> choose_messages(const StreamSettings& settings,
                                                         const DbcFile& dbc) {
  std::vector<const DbcMessage*> chosen;
  if (settings.messages.empty() && dbc.messages.size() == 1) {
    return std::vector<const DbcMessage*>{&dbc.messages.front()};
  }
  if (settings.messages.empty()) {
    return refused(dbc.path.string() + " has " + std::to_string(dbc.messages.size()) +
                   " messages; name those of the sensor with 'messages' (" + message_names(dbc) +
                   ")");
  }
  for (const std::string& wanted : settings.messages) {
    const DbcMessage* found = dbc.message(wanted);
    for (const DbcMessage& message :
         dbc.messages) { // an id in hexadecimal is a name too: files give several messages one name
      if (found == nullptr && wanted.starts_with("0x") &&
          message.id == std::strtoul(wanted.c_str(), nullptr, 16)) {
        found = &message;
      }
    }
    if (found == nullptr) {
      return refused(dbc.path.string() + " has no message '" + wanted + "'; it has " +
                     message_names(dbc));
    }
    if (std::find(chosen.begin(), chosen.end(), found) != chosen.end()) {
      return refused("message '" + wanted + "' is named twice");
    }
    chosen.push_back(found);
  }
  return chosen;
}

Expected<std::vector<const DbcSignal*>> find_keys(const SensorLayout& layout,
                                                  const std::string& name, const DbcFile& dbc) {
  std::vector<const DbcSignal*> keys;
  for (const DbcMessage* message : layout.messages) {
    const DbcSignal* key = message->signal(name);
    if (key == nullptr) {
      return refused(dbc.path.string() + ": message '" + message->name + "' has no signal '" +
                     name +
                     "'; frames of one sample can only be joined by what stands in each of them");
    }
    if (key->multiplexing || key->type == RawType::float32 || key->type == RawType::float64 ||
        (!keys.empty() && keys.front()->length_bits != key->length_bits)) {
      return refused(dbc.path.string() + ":" + std::to_string(key->line) + ": '" + name +
                     "' must be a whole number in every frame, of the same width in all messages, "
                     "to count samples");
    }
    keys.push_back(key);
  }
  return keys;
}

Expected<ChannelLayout> lay_out_channel(const StreamSettings& settings, const SensorLayout& layout,
                                        std::size_t message, std::size_t index,
                                        const std::string& name, const DbcFile& dbc) {
  const DbcSignal& signal = layout.messages[message]->signals[index];
  ChannelLayout channel{message, index, 1.0, {}};
  channel.description.name = name;
  if (const auto given = settings.units.find(name); given != settings.units.end()) {
    channel.description.unit = given->second;
  } else if (const auto unit = signal_unit(signal.unit)) {
    channel.description.unit = unit->d_si;
    channel.description.quantity = unit->quantity;
    channel.unit_factor = unit->factor;
  } else {
    return refused(dbc.path.string() + ":" + std::to_string(signal.line) + ": signal '" +
                   signal.name + "' has the unknown unit '" + signal.unit +
                   "'; give its D-SI unit with units = { " + name +
                   " = \"...\" }, or leave it out of 'channels'");
  }
  const bool is_float = signal.type == RawType::float32 || signal.type == RawType::float64;
  channel.description.resolution = is_float ? 0.0 : std::abs(signal.factor * channel.unit_factor);
  if (signal.minimum < signal.maximum) {
    channel.description.minimum = signal.minimum * channel.unit_factor;
    channel.description.maximum = signal.maximum * channel.unit_factor;
  }
  return channel;
}

Expected<void> add_channels(const StreamSettings& settings, SensorLayout& layout,
                            const DbcFile& dbc) {
  std::vector<std::string> unused;
  for (const auto& [signal, name] : settings.channels) {
    unused.push_back(signal);
  }
  for (std::size_t m = 0; m < layout.messages.size(); ++m) {
    const DbcMessage& message = *layout.messages[m];
    for (std::size_t i = 0; i < message.signals.size(); ++i) {
      const std::string& signal = message.signals[i].name;
      const auto named = settings.channels.find(signal);
      unused.erase(std::remove(unused.begin(), unused.end(), signal), unused.end());
      const bool is_key = signal == settings.counter || signal == settings.time_field;
      if (settings.channels.empty() ? is_key : named == settings.channels.end()) {
        continue;
      }
      DYNCAL_TRY(auto channel,
                 lay_out_channel(settings, layout, m, i,
                                 named == settings.channels.end() ? signal : named->second, dbc));
      const bool taken = std::any_of(layout.channels.begin(), layout.channels.end(),
                                     [&](const ChannelLayout& other) {
                                       return other.description.name == channel.description.name;
                                     });
      if (taken) {
        return refused("two signals would be the channel '" + channel.description.name +
                       "'; name them apart with 'channels'");
      }
      layout.channels.push_back(std::move(channel));
    }
  }
  if (!unused.empty()) {
    return refused(dbc.path.string() + " has no signal '" + unused.front() +
                   "' in the messages of the sensor");
  }
  if (layout.channels.empty()) {
    return refused(dbc.path.string() + ": the messages of the sensor have no signal to publish");
  }
  return {};
}

Expected<void> add_keys(const StreamSettings& settings, SensorLayout& layout, const DbcFile& dbc) {
  // The time field numbers samples as well as a counter does; where both are there it also times
  // them.
  const std::string& name = settings.time_field.empty() ? settings.counter : settings.time_field;
  if (name.empty()) {
    if (layout.messages.size() > 1) {
      return refused("a sample of several messages must be joined by 'counter' or 'time_field', a "
                     "signal that each of them has");
    }
    return {};
  }
  DYNCAL_TRY(layout.keys, find_keys(layout, name, dbc));
  layout.key_is_time = !settings.time_field.empty();
  if (!layout.key_is_time) {
    layout.key_rate_hz = layout.nominal_rate_hz;
    layout.key_tick_s = layout.nominal_rate_hz > 0.0 ? 1.0 / layout.nominal_rate_hz : 0.0;
    return {};
  }
  layout.key_tick_s = settings.time_field_tick_s;
  if (layout.key_tick_s <= 0.0) {
    const DbcSignal& field = *layout.keys.front();
    const auto unit = signal_unit(field.unit);
    if (!unit || unit->d_si != "\\second" || !(field.factor > 0.0)) {
      return refused(
          dbc.path.string() + ":" + std::to_string(field.line) + ": time field '" + field.name +
          "' has no unit of time; give the seconds of one step with 'time_field_tick_s'");
    }
    layout.key_tick_s = field.factor * unit->factor;
  }
  layout.key_rate_hz = 1.0 / layout.key_tick_s;
  return {};
}

Expected<void> check_time_source(const StreamSettings& settings, const SensorLayout& layout) {
  if (settings.time_source == TimeSource::payload_time && !layout.key_is_time) {
    return refused(
        "time source 'payload-time' needs 'time_field', the signal that tells the sensor's time");
  }
  if (settings.time_source == TimeSource::counter &&
      (layout.keys.empty() || layout.key_is_time || layout.nominal_rate_hz <= 0.0)) {
    return refused("time source 'counter' needs 'counter', the signal that counts samples, and "
                   "'nominal_rate_hz'");
  }
  return {};
}

} // namespace

Expected<SensorLayout> lay_out(const StreamSettings& settings, const DbcFile& dbc) {
  SensorLayout layout;
  DYNCAL_TRY(layout.messages, choose_messages(settings, dbc));
  layout.nominal_rate_hz = settings.nominal_rate_hz;
  if (layout.nominal_rate_hz <= 0.0 && layout.messages.front()->cycle_time_s) {
    layout.nominal_rate_hz = 1.0 / *layout.messages.front()->cycle_time_s;
  }
  for (const auto step : {add_keys, add_channels}) {
    DYNCAL_TRY(step(settings, layout, dbc));
  }
  DYNCAL_TRY(check_time_source(settings, layout));
  return layout;
}

} // namespace dyncal::drivers::can
