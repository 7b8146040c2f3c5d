// Where a sample of one sensor stands in its stream: the 32-bit sample number of the unit unwrapped
// to 64 bits, and what each arrival is.
//
// The unit counts every sample, sent or not, so a jump of the number is the only sign of a loss.
// The number starts at 1 when the sensor is initialised, and wraps at 2^32. A number that does not
// lie ahead is a copy of what came before (same number and stamp), a datagram that overtook or was
// overtaken (its place was counted as lost, and stays lost), something old that the unit had kept,
// or the beginning of a new numbering; the stamp decides, and where stamps cannot be trusted the
// next numbers do: sixteen in a row are a new numbering. One thread at a time; never fails.
#pragma once

#include <array>
#include <cstdint>

namespace dyncal::drivers::smartup {

enum class Arrival {
  next,      // as expected, or the first of all
  after_gap, // `missing` samples before it never came
  restart,   // the first of a new numbering
  duplicate, // came before
  late,      // belongs into a gap that has been passed
  stale      // from long ago
};

struct Place {
  Arrival arrival = Arrival::next;
  std::uint64_t sample = 0;  // unwrapped; only for next, after_gap and restart
  std::uint64_t missing = 0; // only for after_gap
};

class SampleNumbering {
public:
  [[nodiscard]] Place place(std::uint32_t number, std::int64_t stamp_ns);

  // A sample that came but could not be used is not missing: the next number is expected behind it.
  // False when it did not lie right ahead.
  bool skip(std::uint32_t number);

private:
  struct Seen {
    std::uint32_t number = 0;
    std::int64_t stamp_ns = 0;
    bool valid = false;
  };
  static constexpr std::size_t remembered = 256; // samples: two dozen datagrams
  static constexpr std::uint32_t max_gap =
      1U << 24U; // hours at 1 kS/s; beyond that it is another numbering
  static constexpr std::uint32_t plain_gap =
      64; // up to here a gap is believed whatever the stamp says
  static constexpr std::int64_t clearly_earlier_ns =
      1'500'000'000; // more than a second that is mislabelled
  static constexpr std::uint32_t new_numbering_proof = 16;

  [[nodiscard]] Arrival look_back(std::uint32_t number, std::int64_t stamp_ns);
  [[nodiscard]] Arrival unless_it_continues(std::uint32_t number);
  Place accept(Arrival arrival, std::uint32_t number, std::int64_t stamp_ns, std::uint64_t sample,
               std::uint64_t missing);
  void forget();

  bool started_ = false;
  std::uint32_t last_number_ = 0;
  std::int64_t last_stamp_ns_ = 0;
  std::uint64_t last_sample_ = 0;
  std::array<Seen, remembered> seen_{};
  std::uint32_t next_odd_number_ = 0; // of a run of numbers that do not fit
  std::uint32_t odd_in_a_row_ = 0;
};

} // namespace dyncal::drivers::smartup
