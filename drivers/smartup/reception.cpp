#include "drivers/smartup/reception.hpp"

#include <utility>

namespace dyncal::drivers::smartup {

namespace {

constexpr std::int64_t report_interval_ns = 500'000'000;
constexpr std::int64_t sender_silent_ns = 2'000'000'000;

} // namespace

std::string Sender::text() const {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += std::to_string((address >> static_cast<unsigned>(shift)) & 0xFFU);
    text += shift > 0 ? '.' : ':';
  }
  return text + std::to_string(port);
}

Reception::Reception(std::vector<WantedSensor> wanted, ReceptionObserver& observer)
    : observer_(observer) {
  for (const WantedSensor& one : wanted) {
    sensors_.emplace(one.settings.sensor,
                     std::make_unique<Entry>(Entry{.sensor = Sensor(one), .sender = {}}));
  }
  for (const auto& [settings, sink] : wanted) {
    if (!settings.sync_sensor) {
      continue;
    }
    if (Entry* sync = entry_of(*settings.sync_sensor)) {
      sync->sensor.give_sync_to(sensors_.at(settings.sensor)->sensor);
    }
  }
}

// Nothing when there are too many.
Reception::Entry* Reception::entry_of(std::uint32_t sensor) {
  if (const auto found = sensors_.find(sensor); found != sensors_.end()) {
    return found->second.get();
  }
  if (sensors_.size() >= max_sensors) {
    return nullptr;
  }
  auto entry = std::make_unique<Entry>(Entry{.sensor = Sensor(sensor), .sender = {}});
  return sensors_.emplace(sensor, std::move(entry)).first->second.get();
}

Reception::Entry* Reception::entry_from(std::uint32_t sensor, Sender sender, HostTime now) {
  Entry* entry = entry_of(sensor);
  if (entry == nullptr) {
    ++counts_.refused;
    return nullptr;
  }
  if (entry->received && entry->sender != sender &&
      now.monotonic_ns - entry->last_ns < sender_silent_ns) {
    entry->sensor.add_other_sender();
    return nullptr;
  }
  entry->received = true;
  entry->sender = sender;
  entry->last_ns = now.monotonic_ns;
  return entry;
}

Reception::Unit* Reception::unit_of(Sender sender) {
  if (const auto found = units_.find(sender); found != units_.end()) {
    return &found->second;
  }
  if (units_.size() >= max_units) {
    return nullptr;
  }
  return &units_[sender];
}

void Reception::take_data(std::size_t datagram_bytes, Unit& unit, Sender sender, HostTime now) {
  bool begun = false;
  for (const DataMessage& message : datagram_.data) {
    Entry* entry = entry_from(message.sensor, sender, now);
    if (entry == nullptr) {
      continue;
    }
    const auto missing = entry->sensor.take(message, now);
    if (!missing) {
      continue;
    }
    if (!std::exchange(begun, true)) {
      unit.losses.begin(datagram_bytes);
    }
    unit.losses.message(message.sensor, *missing, message.bytes);
  }
  if (!begun) {
    return;
  }
  const std::uint64_t lost_before = unit.losses.datagrams_lost();
  for (const AttributedLoss& loss : unit.losses.end()) {
    entry_of(loss.sensor)->sensor.add_loss(loss.in_unit, loss.on_way);
  }
  counts_.found_lost += unit.losses.datagrams_lost() - lost_before;
}

void Reception::take_rejected() {
  for (const RejectedMessage& rejected : datagram_.rejected) {
    const auto known = rejected.sensor ? sensors_.find(*rejected.sensor) : sensors_.end();
    if (known == sensors_.end()) {
      ++counts_.rejected[static_cast<std::size_t>(rejected.cause)];
    } else {
      known->second->sensor.reject(rejected);
    }
  }
  if (datagram_.broken) {
    ++counts_.rejected[static_cast<std::size_t>(*datagram_.broken)];
  }
}

void Reception::take(std::span<const std::uint8_t> bytes, Sender sender, HostTime now) {
  ++counts_.datagrams;
  decode(bytes, datagram_);
  if (datagram_.data.empty() && datagram_.descriptions.empty()) {
    take_rejected();
    return;
  }
  Unit* unit = unit_of(sender);
  if (unit == nullptr) {
    ++counts_.refused;
    return;
  }
  take_rejected();
  take_data(bytes.size(), *unit, sender, now);
  for (const DescriptionMessage& description : datagram_.descriptions) {
    if (Entry* entry = entry_from(description.sensor, sender, now)) {
      entry->sensor.take(description, now);
    }
  }
}

void Reception::report() {
  for (const auto& [sensor, entry] : sensors_) {
    if (entry->received) {
      entry->sensor.count(counts_);
      observer_.on_report(entry->sensor.report(entry->sender.text()));
    }
  }
  observer_.on_report(counts_);
}

void Reception::tick(HostTime now) {
  for (auto& [sensor, entry] : sensors_) {
    if (entry->received) {
      entry->sensor.tick(now);
    }
  }
  if (now.monotonic_ns - last_report_ns_ < report_interval_ns) {
    return;
  }
  last_report_ns_ = now.monotonic_ns;
  report();
}

void Reception::finish(HostTime now) {
  for (auto& [sensor, entry] : sensors_) {
    if (entry->received) {
      entry->sensor.finish(now);
    }
  }
  report();
}

} // namespace dyncal::drivers::smartup
