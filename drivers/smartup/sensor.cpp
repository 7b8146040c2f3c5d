#include "drivers/smartup/sensor.hpp"

#include <algorithm>
#include <utility>

#include "drivers/smartup/sensor_id.hpp"

namespace dyncal::drivers::smartup {

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;
// They come every 4 s, and one of them may be lost.
constexpr std::int64_t max_wait_for_description_ns = 9 * second_ns;
constexpr std::uint64_t max_beginning = 16; // samples of one sensor in one datagram
constexpr std::int64_t pause_of_sensor_ns = 2 * second_ns;
constexpr std::int64_t pause_in_steps = 10;
constexpr double tick_of_unit_s = 1.0 / 108e6;
// Of the GPS second pulse, common to all stamps; not in the unit's own figure.
constexpr double u_gps_pulse_s = 100e-9;

// The unit sends four standard uncertainties.
std::uint32_t standard_uncertainty_ns(std::uint32_t sent) {
  return sent / 4 + (sent % 4 != 0 ? 1 : 0);
}

} // namespace

Sensor::Sensor(std::uint32_t sensor)
    : sensor_(sensor), sink_(nullptr), blocks_(SensorSettings{}.block_ns) {}

Sensor::Sensor(WantedSensor wanted)
    : sensor_(wanted.settings.sensor), settings_(std::move(wanted.settings)), sink_(wanted.sink),
      blocks_(settings_->block_ns) {}

void Sensor::give_sync_to(Sensor& owner) {
  sync_of_ = &owner;
  owner.sync_ = this;
}

// Stale samples show when the first samples are followed by a pause that is long against the steps
// on its other side.
bool Sensor::all_stale_before(const DataMessage& message, std::uint64_t missing) {
  const std::int64_t step_ns = message.stamp_ns() - beginning_.last_stamp_ns;
  const std::int64_t step_before_ns = std::exchange(beginning_.last_step_ns, step_ns);
  beginning_.last_stamp_ns = message.stamp_ns();
  if (++beginning_.samples < 3 || beginning_.samples > max_beginning || missing > 0) {
    return false;
  }
  const auto is_pause = [](std::int64_t pause_ns, std::int64_t other_ns) {
    return pause_ns > pause_of_sensor_ns && other_ns > 0 && pause_ns / pause_in_steps > other_ns;
  };
  return is_pause(step_ns, step_before_ns) ||
         (beginning_.samples == 3 && is_pause(step_before_ns, step_ns));
}

void Sensor::discard_stale() {
  // The sample that showed the pause counts as one of the stale ones only if it lies before it: it
  // is taken afterwards.
  const std::size_t waiting = join_.discard() + blocks_.discard();
  counts_.stale += waiting;
  counts_.received -= waiting;
  stamps_ = StampCheck();
}

void Sensor::begin_numbering(HostTime now) {
  ++counts_.restarts;
  if (!session_has_blocks_ && beginning_.samples <= max_beginning) {
    discard_stale();
  } else {
    join_.release();
    drain_join(now);
    hand_over(blocks_.flush());
    announce_new_session();
  }
  beginning_ = {};
  stamps_ = StampCheck();
}

void Sensor::announce_new_session() {
  if (session_has_blocks_) {
    sink_->warn("sensor " + sensor_text(sensor_) +
                ": a new session begins, the unit has restarted the numbering or sends other "
                "channels");
    sink_->begin_session();
  }
  session_has_blocks_ = false;
}

std::optional<std::uint64_t> Sensor::take(const DataMessage& message, HostTime now) {
  const Place place = numbering_.place(message.sample_number, message.stamp_ns());
  switch (place.arrival) {
  case Arrival::duplicate:
    ++counts_.duplicates;
    return std::nullopt;
  case Arrival::late:
    ++counts_.late;
    return std::nullopt;
  case Arrival::stale:
    ++counts_.stale;
    return std::nullopt;
  case Arrival::restart:
    begin_numbering(now);
    break;
  case Arrival::next:
  case Arrival::after_gap:
    break;
  }
  if (!first_sample_ns_) {
    first_sample_ns_ = now.monotonic_ns;
  }
  if (all_stale_before(message, place.missing) && !session_has_blocks_) {
    discard_stale();
  }

  SampleRow row{.sample = place.sample,
                .stamp_ns = message.stamp_ns(),
                .stamp_uncertainty_ns = standard_uncertainty_ns(message.time_uncertainty_ns),
                .present = message.present,
                .values = message.values};
  row.flags = stamps_.check(
      {place.sample, row.stamp_ns, message.time_uncertainty_ns, message.unix_time_s == 0});
  ++counts_.received;
  counts_.stamp_uncertainty_ns = row.stamp_uncertainty_ns;
  if (row.flags != 0) {
    ++counts_.stamps_not_trusted;
    for (std::size_t bit = 0; bit < stamp_flag_count; ++bit) {
      counts_.stamp_flags[bit] += (row.flags >> bit) & 1U;
    }
  }

  if (sync_of_ != nullptr) {
    sync_of_->take_sync(message, now);
  }
  if (!settings_) {
    return place.missing;
  }
  if (sync_ != nullptr) {
    join_.add(row);
    drain_join(now);
  } else {
    assemble(row, now);
  }
  return place.missing;
}

void Sensor::take_sync(const DataMessage& message, HostTime now) {
  join_.add_sync(message.stamp_ns(), message.present, message.values);
  drain_join(now);
}

void Sensor::drain_join(HostTime now) {
  SampleRow row;
  while (join_.take(row)) {
    assemble(row, now);
  }
  counts_.without_sync = join_.without_sync();
}

void Sensor::assemble(const SampleRow& row, HostTime now) {
  const Columns columns = blocks_.columns();
  const Columns wider{static_cast<std::uint16_t>(columns.own | row.present),
                      static_cast<std::uint16_t>(columns.sync | row.sync_present)};
  if (wider != columns) {
    if (session_has_blocks_) {
      ++counts_.new_columns;
      hand_over(blocks_.flush());
      announce_new_session();
    }
    blocks_.set_columns(wider);
    description_changed_ = true;
    describe(now);
  }
  hand_over(blocks_.add(row, stamps_.period_ns(), now));
}

void Sensor::hand_over(std::optional<SampleBlock> block) {
  if (!block) {
    return;
  }
  session_has_blocks_ = true;
  sink_->take(std::move(*block));
}

void Sensor::take(const DescriptionMessage& message, HostTime now) {
  if (!declared_.add(message)) {
    return;
  }
  description_changed_ = true;
  for (const std::string& warning : declared_.warnings()) {
    warn_once(warning);
  }
  if (sync_of_ != nullptr) {
    sync_of_->description_changed_ = true;
    sync_of_->describe(now);
  }
  describe(now);
}

// To those that get this sensor's samples.
void Sensor::warn_once(const std::string& sentence) {
  if (!warned_.insert(sentence).second) {
    return;
  }
  const std::string text = "sensor " + sensor_text(sensor_) + ": " + sentence;
  for (SampleSink* sink : {sink_, sync_of_ != nullptr ? sync_of_->sink_ : nullptr}) {
    if (sink != nullptr) {
      sink->warn(text);
    }
  }
}

// Hands on what is known as soon as it is whole, or when waiting for the rest has taken too long;
// later whenever it changes.
void Sensor::describe(HostTime now) {
  if (!settings_ || !description_changed_ || blocks_.columns() == Columns{}) {
    return;
  }
  const bool whole = declared_.complete() && (sync_ == nullptr || sync_->declared_.complete());
  const bool waited =
      first_sample_ns_ && now.monotonic_ns - *first_sample_ns_ >= max_wait_for_description_ns;
  if (!described_ && !whole && !waited) {
    return;
  }
  described_ = true;
  description_changed_ = false;
  const SourceDescription known = description();
  check_names(known);
  sink_->describe(known);
}

void Sensor::check_names(const SourceDescription& description) {
  for (const auto& [device_name, ours] : settings_->naming.names) {
    if (std::ranges::count(description.channels, ours, &ChannelDescription::name) == 0) {
      warn_once("channel " + device_name + " is to be called '" + ours +
                "', but the sensor sends no such channel");
    }
  }
}

SourceDescription Sensor::description() const {
  SourceDescription description;
  description.device = declared_.sensor_name();
  description.serial = sensor_text(sensor_);
  description.driver = "smartup";
  description.channels = declared_.channels(blocks_.columns().own, settings_->naming);
  if (sync_ != nullptr) {
    for (auto& channel :
         sync_->declared_.channels(blocks_.columns().sync, settings_->naming, "sync_")) {
      description.channels.push_back(std::move(channel));
    }
  }
  description.time_base = settings_->time_base;
  description.stamp_instant = StampInstant::data_ready_edge;
  description.tick_s = tick_of_unit_s;
  description.stamp_uncertainty_s = u_gps_pulse_s;
  return description;
}

void Sensor::reject(const RejectedMessage& message) {
  ++counts_.rejected[static_cast<std::size_t>(message.cause)];
  if (message.sample_number) {
    numbering_.skip(*message.sample_number);
  }
}

void Sensor::add_loss(std::uint64_t in_unit, std::uint64_t on_way) {
  counts_.lost_in_unit += in_unit;
  counts_.lost_on_way += on_way;
}

void Sensor::tick(HostTime now) {
  describe(now);
  hand_over(blocks_.flush(now));
}

void Sensor::finish(HostTime now) {
  join_.release();
  drain_join(now);
  hand_over(blocks_.flush());
}

void Sensor::count(const ReceptionCounts& reception) const {
  if (sink_ != nullptr) {
    sink_->count(sample_counts(counts_, reception));
  }
}

SensorReport Sensor::report(const std::string& sender) const {
  return {sensor_, declared_.sensor_name(), sender, settings_.has_value() || sync_of_ != nullptr,
          counts_};
}

} // namespace dyncal::drivers::smartup
