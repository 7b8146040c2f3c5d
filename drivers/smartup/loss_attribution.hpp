// Who lost the samples that are missing: the unit itself, or the way from it.
//
// The unit numbers samples, not datagrams, so the loss of a datagram must be recognised by its
// shape: at one place of the stream, between two datagrams, the sensors of the unit miss samples
// that together fill at least one datagram; and no sensor that is in every datagram goes on there
// without a gap. Anything else was lost inside the unit: a gap in the middle of a datagram, or of a
// few samples of one sensor. A slow sensor notices only later: its gap is on the way when a
// datagram was found lost since the sensor was seen last. Limit of the method: a burst of one
// sensor lost in a unit that has no other sensor looks like a datagram.
//
// For each datagram with data, in the order of arrival: begin(), message() for each sample that is
// taken, end(). One thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace dyncal::drivers::smartup {

struct AttributedLoss {
  std::uint32_t sensor = 0;
  std::uint64_t in_unit = 0;
  std::uint64_t on_way = 0;
};

class LossAttribution {
public:
  void begin(std::size_t datagram_bytes);
  void message(std::uint32_t sensor, std::uint64_t missing, std::size_t message_bytes);
  // The losses noticed in this datagram; valid until the next begin().
  [[nodiscard]] std::span<const AttributedLoss> end();

  // Datagrams that were found lost, as far as whole ones can be told.
  [[nodiscard]] std::uint64_t datagrams_lost() const { return datagrams_lost_; }

private:
  struct SensorTrace {
    std::uint32_t sensor = 0;
    std::uint64_t last_datagram = 0;
    std::uint32_t datagrams_in_a_row = 0;
  };
  struct Gap {
    std::uint32_t sensor = 0;
    std::uint64_t missing = 0;
    std::size_t bytes = 0;           // that the missing samples would have taken
    std::uint64_t last_datagram = 0; // that had this sensor
    bool between_datagrams = false;
  };

  SensorTrace& trace_of(std::uint32_t sensor);
  [[nodiscard]] bool datagram_is_missing() const;
  [[nodiscard]] bool lost_since(std::uint64_t datagram) const;

  std::uint64_t datagram_ = 0; // number of the present one, counted as they arrive
  std::size_t datagram_bytes_ = 0;
  double usual_bytes_ = 0.0;
  std::vector<SensorTrace> traces_;
  std::vector<std::uint32_t>
      without_gap_; // sensors of this datagram whose first sample follows its predecessor
  std::vector<Gap> gaps_;
  std::deque<std::uint64_t>
      losses_; // numbers of the datagrams before which one was lost, the most recent
  std::uint64_t datagrams_lost_ = 0;
  std::vector<AttributedLoss> attributed_;
};

} // namespace dyncal::drivers::smartup
