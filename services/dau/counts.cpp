#include "services/dau/counts.hpp"

#include <cmath>
#include <numeric>
#include <string>

namespace dyncal::services::dau {

namespace {

namespace smartup = drivers::smartup;

constexpr double pulse_uncertainty_ns =
    100.0; // of the GPS second pulse, which the unit's own figure leaves out

void add_cause(SourceCounts& counts, std::string name, std::uint64_t value) {
  if (value > 0) {
    counts.causes.emplace_back(std::move(name), value);
  }
}

} // namespace

SourceCounts source_counts(const smartup::SensorCounts& sensor,
                           const smartup::ReceptionCounts& reception) {
  SourceCounts counts;
  counts.received = sensor.received;
  counts.lost_in_device = sensor.lost_in_unit;
  counts.lost_on_way = sensor.lost_on_way;
  counts.duplicates = sensor.duplicates;
  counts.rejected =
      std::accumulate(sensor.rejected.begin(), sensor.rejected.end(), std::uint64_t{0});
  counts.stamps_not_trusted = sensor.stamps_not_trusted;
  if (sensor.stamp_uncertainty_ns > 0) {
    counts.clock_uncertainty_s =
        std::hypot(sensor.stamp_uncertainty_ns, pulse_uncertainty_ns) * 1e-9;
  }

  add_cause(counts, "late", sensor.late);
  add_cause(counts, "stale", sensor.stale);
  add_cause(counts, "numbering restarted", sensor.restarts);
  add_cause(counts, "new channels", sensor.new_columns);
  add_cause(counts, "same id from another sender", sensor.other_sender);
  add_cause(counts, "without sync", sensor.without_sync);
  for (std::size_t bit = 0; bit < smartup::stamp_flag_count; ++bit) {
    add_cause(counts, smartup::to_string(static_cast<drivers::StampFlag>(1U << bit)),
              sensor.stamp_flags[bit]);
  }
  for (std::size_t i = 0; i < smartup::rejections; ++i) {
    const std::string name = smartup::to_string(static_cast<smartup::Rejection>(i));
    add_cause(counts, "rejected: " + name, sensor.rejected[i]);
    add_cause(counts, "datagrams: " + name, reception.rejected[i]);
  }
  add_cause(counts, "datagrams: dropped by the kernel", reception.dropped_by_kernel);
  add_cause(counts, "datagrams: found lost", reception.found_lost);
  add_cause(counts, "datagrams: too long", reception.too_long);
  add_cause(counts, "datagrams: too many units or sensors", reception.refused);
  return counts;
}

} // namespace dyncal::services::dau
