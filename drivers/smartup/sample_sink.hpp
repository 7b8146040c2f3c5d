// Where a receiver of SmartUp Units puts what it has received: implemented by whoever wants the
// samples.
//
// All functions are called on the receiver's thread, one after the other, and must not block: the
// socket waits meanwhile.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "drivers/sample_block.hpp"
#include "drivers/smartup/datagram.hpp"
#include "drivers/smartup/stamp_check.hpp"

namespace dyncal::drivers::smartup {

// Of one sensor since the receiver started. Every sample number that was passed is received, lost
// or rejected.
struct SensorCounts {
  std::uint64_t received = 0;
  std::uint64_t lost_in_unit = 0;
  std::uint64_t lost_on_way = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t late = 0;         // came after its place had been counted as lost; it stays lost
  std::uint64_t stale = 0;        // kept by the unit from before a pause or restart, not handed on
  std::uint64_t restarts = 0;     // of the numbering
  std::uint64_t other_sender = 0; // same id from a second sender, not handed on
  std::uint64_t new_columns = 0;  // channels appeared that had not been there
  std::uint64_t without_sync = 0; // samples whose partner of the sync sensor never came
  std::array<std::uint64_t, rejections> rejected{};
  std::array<std::uint64_t, stamp_flag_count> stamp_flags{};
  std::uint64_t stamps_not_trusted = 0; // samples with at least one flag
  std::uint32_t stamp_uncertainty_ns =
      0; // standard uncertainty of the newest stamp in the unit's clock; 0: it does not know
};

struct SensorReport {
  std::uint32_t sensor = 0;
  std::string name;    // "" as long as no description has come
  std::string sender;  // address and port of the unit
  bool wanted = false; // its blocks are handed on, itself or as a sync sensor
  SensorCounts counts;
};

// Of one address that is listened to.
struct ReceptionCounts {
  std::uint64_t datagrams = 0;
  std::uint64_t dropped_by_kernel = 0; // datagrams: the receive buffer was full
  std::uint64_t found_lost = 0; // datagrams that never came, as far as whole ones can be told
  std::uint64_t too_long = 0;   // datagrams longer than any of a unit
  std::uint64_t refused =
      0; // datagrams or messages of more units or sensors than can be kept apart
  std::array<std::uint64_t, rejections> rejected{}; // datagrams, and messages of no known sensor
};

class SampleSink {
public:
  virtual ~SampleSink() = default;

  // Known, or changed: five seconds after the first sample at the latest. The columns of the blocks
  // are its channels.
  virtual void on_description(std::uint32_t sensor, const SourceDescription& description) = 0;
  // Once for each oddity of what the sensor declares.
  virtual void on_warning(std::uint32_t sensor, const std::string& sentence) = 0;
  // The blocks that follow have a new numbering or other columns.
  virtual void on_new_session(std::uint32_t sensor) = 0;
  virtual void on_block(std::uint32_t sensor, SampleBlock block) = 0;
  // About twice a second: each sensor that was ever received, and the address as a whole.
  virtual void on_report(const SensorReport& report) = 0;
  virtual void on_report(const ReceptionCounts& counts) = 0;
};

} // namespace dyncal::drivers::smartup
