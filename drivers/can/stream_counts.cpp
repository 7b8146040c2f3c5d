#include "drivers/can/stream_counts.hpp"

namespace dyncal::drivers::can {

SampleCounts sample_counts(const StreamCounts& stream, const LinkState& link, double u_clock_s) {
  SampleCounts counts;
  counts.received = stream.samples;
  counts.lost_on_way = stream.lost;
  counts.duplicates = stream.repeated;
  counts.rejected = stream.rejected + stream.incomplete;
  counts.stamps_not_trusted = stream.not_trusted;
  counts.clock_uncertainty_s = u_clock_s;
  counts.add_cause("frames received", stream.frames);
  counts.add_cause("frames dropped by the socket", stream.dropped_frames);
  counts.add_cause("samples with a missing frame", stream.incomplete);
  counts.add_cause("frames without counter, SYNC or known rate", stream.rejected);
  counts.add_cause("samples that came behind later ones", stream.late);
  counts.add_cause("signals beyond the end of a frame", stream.short_frames);
  counts.add_cause("signals not available or in error", stream.no_value);
  counts.add_cause("interruptions of the link", stream.interruptions);
  counts.add_cause("restarts of the sensor", stream.restarts);
  counts.add_cause("restarts of a clock", stream.clock_restarts);
  for (const auto& [cause, number] : stream.faults) {
    counts.add_cause("bus: " + cause, number);
  }
  counts.add_cause("controller restarts", link.restarts);
  counts.add_cause("transmit error counter", link.transmit_errors.value_or(0));
  counts.add_cause("receive error counter", link.receive_errors.value_or(0));
  return counts;
}

} // namespace dyncal::drivers::can
