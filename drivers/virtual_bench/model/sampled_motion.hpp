// Displacement of the table and signal of sync at the equidistant instants of an instrument that
// samples fast: the same as Excitation gives for each instant, at a tenth of its cost.
//
// Samples belong to blocks of 128, counted from sample 0. For each block the carrier of each line
// is computed once; powers of its step, which are kept as long as the frequency is the same, turn
// it to the other samples. Factors that wander with seconds follow straight lines within a block. A
// sample depends on its number only, not on how bench time is cut.
//
//   instant of sample n: n * interval; displacement is that of `delay` before, where the
//   fundamental is `spot` times that of the table: a spot beside the sensor moves a little
//   differently. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/virtual_bench/model/excitation.hpp"

namespace dyncal::drivers::virtual_bench {

struct SyncLevel {
  double amplitude_v = 9.75;
  bool is_first_output = false; // has the amplitude of what drives the exciter

  [[nodiscard]] double of(const ExcitationSegment& segment) const {
    return is_first_output ? segment.amplitude_v
           : segment.on    ? amplitude_v * segment.sync_part
                           : 0.0;
  }
};

class SampledMotion {
public:
  static constexpr std::uint64_t block_samples = 128;
  using Block = std::array<double, block_samples>;

  SampledMotion(double interval_s, double delay_s, std::complex<double> spot, const SyncLevel& sync)
      : interval_s_(interval_s), delay_s_(delay_s), spot_(spot), sync_(sync) {}

  // Samples `from` to `to` (exclusive) of a block, into their places in it.
  // REQUIRES: all within one block.
  void sample(std::uint64_t from, std::uint64_t to, const Excitation& excitation,
              Block& displacement_m, Block& sync_v);

private:
  struct Powers { // of k = 0..127 intervals
    double frequency_hz = 0.0;
    double decay_s = 0.0;
    Block cosine{}; // of the carrier
    Block sine{};
    Block left{};     // exp(-k interval / decay_s)
    Block returned{}; // exp(-k interval / suspension)
  };
  struct Place {             // of a block's samples within one segment
    std::uint64_t first = 0; // sample of the block
    std::size_t from = 0;    // in the block
    std::size_t to = 0;
  };
  void add_segment(const Place& place, const Excitation& excitation,
                   const ExcitationSegment& segment, const Powers& powers, Block& displacement_m,
                   Block& sync_v) const;
  const Powers& powers_of(std::size_t line, const ExcitationSegment& segment);
  [[nodiscard]] std::uint64_t first_sample_at(double time_s) const;

  double interval_s_;
  double delay_s_;
  std::complex<double> spot_;
  SyncLevel sync_;
  std::vector<Powers> powers_; // of each line
};

} // namespace dyncal::drivers::virtual_bench
