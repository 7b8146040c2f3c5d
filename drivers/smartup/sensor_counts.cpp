#include "drivers/smartup/sensor_counts.hpp"

#include <cmath>
#include <numeric>
#include <string>

namespace dyncal::drivers::smartup {

namespace {

// Of the GPS second pulse, which the unit's own figure leaves out.
constexpr double u_pulse_ns = 100.0;

} // namespace

SampleCounts sample_counts(const SensorCounts& sensor, const ReceptionCounts& reception) {
  SampleCounts counts;
  counts.received = sensor.received;
  counts.lost_in_device = sensor.lost_in_unit;
  counts.lost_on_way = sensor.lost_on_way;
  counts.duplicates = sensor.duplicates;
  counts.rejected =
      std::accumulate(sensor.rejected.begin(), sensor.rejected.end(), std::uint64_t{0});
  counts.stamps_not_trusted = sensor.stamps_not_trusted;
  if (sensor.stamp_uncertainty_ns > 0) {
    counts.clock_uncertainty_s = std::hypot(sensor.stamp_uncertainty_ns, u_pulse_ns) * 1e-9;
  }

  counts.add_cause("late", sensor.late);
  counts.add_cause("stale", sensor.stale);
  counts.add_cause("numbering restarted", sensor.restarts);
  counts.add_cause("new channels", sensor.new_columns);
  counts.add_cause("same id from another sender", sensor.other_sender);
  counts.add_cause("without sync", sensor.without_sync);
  for (std::size_t bit = 0; bit < stamp_flag_count; ++bit) {
    counts.add_cause(to_string(static_cast<StampFlag>(1U << bit)), sensor.stamp_flags[bit]);
  }
  for (std::size_t i = 0; i < rejections; ++i) {
    const std::string name = to_string(static_cast<Rejection>(i));
    counts.add_cause("rejected: " + name, sensor.rejected[i]);
    counts.add_cause("datagrams: " + name, reception.rejected[i]);
  }
  counts.add_cause("datagrams: dropped by the kernel", reception.dropped_by_kernel);
  counts.add_cause("datagrams: found lost", reception.found_lost);
  counts.add_cause("datagrams: too long", reception.too_long);
  counts.add_cause("datagrams: too many units or sensors", reception.refused);
  return counts;
}

} // namespace dyncal::drivers::smartup
