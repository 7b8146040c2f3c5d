#include "drivers/smartup/loss_attribution.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::smartup {

namespace {

constexpr double whole_datagram =
    0.6; // of the usual size: sizes vary, and slow sensors notice their part later
constexpr double size_memory = 1.0 / 16.0;      // weight of one datagram in the usual size
constexpr std::uint32_t in_every_datagram = 16; // that many in a row
constexpr std::size_t remembered_losses = 64;

} // namespace

LossAttribution::SensorTrace& LossAttribution::trace_of(std::uint32_t sensor) {
  const auto found = std::ranges::find(traces_, sensor, &SensorTrace::sensor);
  if (found != traces_.end()) {
    return *found;
  }
  return traces_.emplace_back(
      SensorTrace{.sensor = sensor, .last_datagram = datagram_ - 1, .datagrams_in_a_row = 0});
}

void LossAttribution::begin(std::size_t datagram_bytes) {
  ++datagram_;
  datagram_bytes_ = datagram_bytes;
  without_gap_.clear();
  gaps_.clear();
  attributed_.clear();
}

void LossAttribution::message(std::uint32_t sensor, std::uint64_t missing,
                              std::size_t message_bytes) {
  SensorTrace& trace = trace_of(sensor);
  const bool first = trace.last_datagram != datagram_;
  if (missing > 0) {
    gaps_.push_back({sensor, missing, static_cast<std::size_t>(missing) * message_bytes,
                     trace.last_datagram, first});
  } else if (first && trace.datagrams_in_a_row >= in_every_datagram) {
    without_gap_.push_back(sensor);
  }
  if (first) {
    trace.datagrams_in_a_row =
        trace.last_datagram + 1 == datagram_ ? trace.datagrams_in_a_row + 1 : 1;
    trace.last_datagram = datagram_;
  }
}

bool LossAttribution::datagram_is_missing() const {
  if (!without_gap_.empty()) {
    return false;
  }
  double missing_bytes = 0.0;
  for (const Gap& gap : gaps_) {
    if (gap.between_datagrams) {
      missing_bytes += static_cast<double>(gap.bytes);
    }
  }
  return missing_bytes > 0.0 && missing_bytes >= whole_datagram * usual_bytes_;
}

bool LossAttribution::lost_since(std::uint64_t datagram) const {
  return std::ranges::any_of(losses_, [&](std::uint64_t before) { return before > datagram; });
}

std::span<const AttributedLoss> LossAttribution::end() {
  if (usual_bytes_ == 0.0) {
    usual_bytes_ = static_cast<double>(datagram_bytes_);
  }
  if (datagram_is_missing()) {
    double missing_bytes = 0.0;
    for (const Gap& gap : gaps_) {
      missing_bytes += static_cast<double>(gap.bytes);
    }
    datagrams_lost_ +=
        static_cast<std::uint64_t>(std::max(1.0, std::round(missing_bytes / usual_bytes_)));
    losses_.push_back(datagram_);
    if (losses_.size() > remembered_losses) {
      losses_.pop_front();
    }
  }
  usual_bytes_ += size_memory * (static_cast<double>(datagram_bytes_) - usual_bytes_);
  for (const Gap& gap : gaps_) {
    const bool on_way = gap.between_datagrams && lost_since(gap.last_datagram);
    attributed_.push_back({gap.sensor, on_way ? 0 : gap.missing, on_way ? gap.missing : 0});
  }
  return attributed_;
}

} // namespace dyncal::drivers::smartup
