// Everything that arrives at one address: several units, told apart by their sender, each with
// several sensors, told apart by their id.
//
// A sensor belongs to the sender it was first received from; the same id from a second sender at
// the same time (two boards with one checksum) is counted and not mixed in. When the first sender
// has been silent for two seconds, the second one is taken for the same unit with a new address.
// Senders and sensors that are kept apart are limited (max_units, max_sensors), so that nobody can
// fill the memory. No sockets here. One thread at a time; never fails.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "drivers/smartup/loss_attribution.hpp"
#include "drivers/smartup/sensor.hpp"

namespace dyncal::drivers::smartup {

// IPv4 address and port of a unit, in the host's byte order.
struct Sender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  friend auto operator<=>(const Sender&, const Sender&) =
      default; // NOLINT(modernize-use-nullptr): clang-tidy 14 errs here
  [[nodiscard]] std::string text() const;
};

class Reception {
public:
  static constexpr std::size_t max_units = 256;
  static constexpr std::size_t max_sensors = 1024;

  // `observer` and the sinks outlive the reception. REQUIRES: no sensor twice in `wanted`, each
  // with a sink.
  Reception(std::vector<WantedSensor> wanted, ReceptionObserver& observer);

  void take(std::span<const std::uint8_t> datagram, Sender sender, HostTime now);
  void add_too_long() { ++counts_.too_long; }
  void set_dropped_by_kernel(std::uint64_t datagrams) { counts_.dropped_by_kernel = datagrams; }

  // To be called at least every 50 ms: hands over what has waited long enough, and reports when
  // that is due.
  void tick(HostTime now);
  // Reception ends: hands over and reports everything.
  void finish(HostTime now);

private:
  struct Unit {
    LossAttribution losses;
  };
  struct Entry {
    Sensor sensor;
    Sender sender;
    bool received = false; // from `sender`
    std::int64_t last_ns = 0;
  };

  Entry* entry_of(std::uint32_t sensor);
  Entry* entry_from(std::uint32_t sensor, Sender sender, HostTime now);
  Unit* unit_of(Sender sender);
  void take_data(std::size_t datagram_bytes, Unit& unit, Sender sender, HostTime now);
  void take_rejected();
  void report();

  ReceptionObserver& observer_;
  std::unordered_map<std::uint32_t, std::unique_ptr<Entry>> sensors_;
  std::map<Sender, Unit> units_;
  ReceptionCounts counts_;
  Datagram datagram_; // kept for its memory
  std::int64_t last_report_ns_ = 0;
};

} // namespace dyncal::drivers::smartup
