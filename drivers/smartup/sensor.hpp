// One sensor of a SmartUp Unit: its numbering, its stamps, its description and its blocks, with an
// account of every sample.
//
// A sensor that nobody wants (no settings, no sink) is accounted for, but its samples go nowhere. A
// sync sensor hands its samples to the sensor that it belongs to. The unit keeps its last, partly
// filled datagram over a pause: samples at the very beginning of a numbering that are followed by a
// jump in time or by a new numbering are stale; they are counted and not handed on.
//
// One thread at a time; never fails.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "drivers/sample_sink.hpp"
#include "drivers/smartup/block_assembly.hpp"
#include "drivers/smartup/description.hpp"
#include "drivers/smartup/reception_observer.hpp"
#include "drivers/smartup/sample_numbering.hpp"
#include "drivers/smartup/stamp_check.hpp"
#include "drivers/smartup/sync_join.hpp"

namespace dyncal::drivers::smartup {

struct SensorSettings {
  std::uint32_t sensor = 0;
  std::optional<std::uint32_t> sync_sensor; // sends the sync ADCs with the same stamps
  ChannelNaming naming;
  TimeBase time_base = TimeBase::utc;
  std::int64_t block_ns = 50'000'000;
};

struct WantedSensor {
  SensorSettings settings;
  SampleSink* sink = nullptr; // outlives the receiver
};

class Sensor {
public:
  // One that is accounted for only.
  explicit Sensor(std::uint32_t sensor);
  explicit Sensor(WantedSensor wanted);

  // This sensor carries the sync of `owner`, which outlives it.
  void give_sync_to(Sensor& owner);

  // The number of samples missing right before this one; nothing when it is not a new sample.
  std::optional<std::uint64_t> take(const DataMessage& message, HostTime now);
  void take(const DescriptionMessage& message, HostTime now);
  void reject(const RejectedMessage& message);
  void add_loss(std::uint64_t in_unit, std::uint64_t on_way);
  void add_other_sender() { ++counts_.other_sender; }

  // Hands over what has waited long enough.
  void tick(HostTime now);
  // Hands over everything: reception ends.
  void finish(HostTime now);
  // To its own sink. `reception` is of its address.
  void count(const ReceptionCounts& reception) const;

  [[nodiscard]] SensorReport report(const std::string& sender) const;

private:
  // The first samples of a numbering, as far as stale ones can be among them.
  struct Beginning {
    std::uint64_t samples = 0;
    std::int64_t last_stamp_ns = 0;
    std::int64_t last_step_ns = 0;
  };

  void begin_numbering(HostTime now);
  [[nodiscard]] bool all_stale_before(const DataMessage& message, std::uint64_t missing);
  void discard_stale();
  void take_sync(const DataMessage& message, HostTime now);
  void drain_join(HostTime now);
  void assemble(const SampleRow& row, HostTime now);
  void hand_over(std::optional<SampleBlock> block);
  void announce_new_session();
  void describe(HostTime now);
  void check_names(const SourceDescription& description);
  void warn_once(const std::string& sentence);
  [[nodiscard]] SourceDescription description() const;

  const std::uint32_t sensor_;
  const std::optional<SensorSettings> settings_;
  SampleSink* const sink_; // set together with the settings
  Sensor* sync_of_ = nullptr;
  Sensor* sync_ = nullptr;

  SampleNumbering numbering_;
  StampCheck stamps_;
  Beginning beginning_;
  DescriptionAssembly declared_;
  SyncJoin join_;
  BlockAssembly blocks_;
  SensorCounts counts_;

  std::optional<std::int64_t> first_sample_ns_; // monotonic
  bool described_ = false;
  bool description_changed_ = false;
  bool session_has_blocks_ = false;
  std::set<std::string> warned_;
};

} // namespace dyncal::drivers::smartup
