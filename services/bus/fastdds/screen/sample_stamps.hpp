// When samples that arrive in fragments were written, by the stamp of their first fragment.
//
// Cyclone DDS puts the source timestamp in front of the first fragment of a sample only
// (DDSI-RTPS 8.3.7.9: it holds for what follows in the same message), Fast DDS in front of each.
// Fast DDS 2.9 files a sample under the stamp of whichever fragment arrives first. Where that is
// not the first one, on a network that loses or reorders packets, it files the sample under time 0,
// in front of all others; a reader then takes samples in an order in which the library has not
// counted them, and an assertion of its own ends the program (DataReaderInstance.hpp).
//
// Bound: max_samples, the oldest is forgotten first. A fragment of a forgotten sample is one of a
// sample that never began. Any thread: the sockets of a participant share one object, since a
// sample can begin on the multicast socket and be repaired on the other.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <tuple>

namespace dyncal::bus {

// As on the wire: seconds since 1970 and 2^-32 s.
struct RtpsStamp {
  std::uint32_t seconds = 0;
  std::uint32_t fraction = 0;
  friend bool operator==(const RtpsStamp&, const RtpsStamp&) = default;
};

class SampleStamps {
public:
  static constexpr std::size_t max_samples = 16'384;

  struct Sample {
    std::array<unsigned char, 12> participant{};
    std::array<unsigned char, 4> writer{};
    std::int64_t sequence = 0;
    friend bool operator<(const Sample& left, const Sample& right) {
      return std::tie(left.participant, left.writer, left.sequence) <
             std::tie(right.participant, right.writer, right.sequence);
    }
  };

  // Its first fragment came; `stamp` is nothing where it had none.
  void begin(const Sample& sample, std::optional<RtpsStamp> stamp);

  // Nothing: the first fragment has not come.
  [[nodiscard]] std::optional<RtpsStamp> of(const Sample& sample) const;

  // What a sample is filed under that has none (DDSI-RTPS 9.3.2: TIME_INVALID).
  static constexpr RtpsStamp invalid{0xffffffffU, 0xffffffffU};

private:
  mutable std::mutex mutex_;
  std::map<Sample, RtpsStamp> stamps_;
  std::deque<Sample> oldest_first_;
};

} // namespace dyncal::bus
