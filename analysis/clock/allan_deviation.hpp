// Overlapping Allan deviation (NIST SP 1065, section 5.2.4) of time stamps:
//
//   sigma_y^2(m tau_0) = sum_i (x_{i+2m} - 2 x_{i+m} + x_i)^2 / (2 m^2 tau_0^2 (N - 2m))
//
// with x_i = t_i - i tau_0 and N phases. The second difference does not see the mean interval, so
// stamps are used as they are, in integers. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dyncal::analysis {

struct AllanPoint {
  double tau_s = 0.0;
  double deviation = 0.0;
};

// Of phases (time errors) in seconds at the spacing tau0_s, for one averaging factor. 0 with no
// more than 2 m phases.
[[nodiscard]] double overlapping_allan_deviation(std::span<const double> phases_s, double tau0_s,
                                                 std::size_t m);

// The same for a stream of stamps at m = 1, 2, 4 ...; keeps the last `max_samples` stamps.
class StreamingAllan {
public:
  explicit StreamingAllan(std::size_t max_samples);

  void add(std::int64_t stamp_ns);
  // The next stamp does not continue the series; sums are kept.
  void interrupt() { in_stretch_ = 0; }
  // Octaves with more terms than m.
  [[nodiscard]] std::vector<AllanPoint> points(double tau0_s) const;

private:
  struct Octave {
    double squares_ns2 = 0.0;
    std::uint64_t terms = 0;
  };
  std::vector<std::int64_t> ring_; // grows to a power of two
  std::size_t longest_;
  std::uint64_t in_stretch_ = 0;
  std::uint64_t total_ = 0;
  std::vector<Octave> octaves_;
};

} // namespace dyncal::analysis
