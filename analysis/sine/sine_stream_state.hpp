// The inside of SineStream: what is kept of a stream. Used by sine_stream.cpp (samples in, three
// parameters out) and sine_stream_frequency.cpp (the frequency out of the kept series); see
// sine_stream.hpp for model, units and failures.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/sine/frequency_series.hpp"
#include "analysis/sine/kernel/sine_kernel.hpp"
#include "analysis/sine/sine_solve.hpp"
#include "analysis/sine/sine_stream.hpp"

namespace dyncal::analysis {
namespace kernel {

using Complex = std::complex<double>;

// A plain product: std::complex's own would look for infinities.
inline Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Sums over any number of blocks, phases about the first stamp: enough for three parameters.
struct Totals {
  double n = 0.0;
  Complex x, xx;
  struct Channel {
    double e = 0.0, ee = 0.0;
    Complex ex;
  };
  std::vector<Channel> channels;

  [[nodiscard]] DesignSums design() const {
    return {-x.imag(), x.real(), 0.5 * (n - xx.real()), -0.5 * xx.imag()};
  }
  [[nodiscard]] ResidualSums residuals(std::size_t j) const {
    return {channels[j].e, -channels[j].ex.imag(), channels[j].ex.real(), channels[j].ee};
  }
};

struct Block {
  DesignFrequencySeries design;
  std::vector<ResidualFrequencySeries> channels;
  double half_length_s = 0.0;

  [[nodiscard]] Segment segment() const { return {&design, channels.data()}; }
};

// Samples of one block.
struct BlockSamples {
  static constexpr std::size_t capacity = 64;
  explicit BlockSamples(std::size_t channels) : values(channels) {}

  std::array<std::int64_t, capacity> stamps{};
  std::vector<std::array<double, capacity>> values;
  std::size_t filled = 0;

  [[nodiscard]] std::int64_t middle_ns() const {
    return stamps[0] + (stamps[filled - 1] - stamps[0]) / 2;
  }
  [[nodiscard]] double half_length_s() const {
    return static_cast<double>(stamps[filled - 1] - stamps[0]) * 0.5e-9;
  }
};

// Power series of a block's samples: computed about the middle of the block, phases then turned to
// the first stamp of the stream. In pieces, the design and then one channel each, so that no sample
// of a stream has to wait for all of them.
class BlockReduction {
public:
  // To begin with samples; their block, start values and the rest stay the same until all pieces
  // are done.
  void begin(std::size_t channels) { pieces_ = channels + 1; }
  [[nodiscard]] bool pending() const { return pieces_ > 0; }
  // REQUIRES: pending().
  void take_piece(const BlockSamples& samples, const Frequency& frequency, std::int64_t first_ns,
                  std::span<const Parameters> start, Block& block);

private:
  std::size_t pieces_ = 0; // that are left
  Complex back_;           // the turn to the first stamp
  BlockBasis basis_;
};

} // namespace kernel

class SineStream::State {
public:
  State(const Frequency& frequency, std::size_t channels)
      : frequency_(frequency), samples_(channels), full_(channels), start_(channels),
        open_(channels) {
    totals_.channels.resize(channels);
  }

  Expected<void> push(std::span<const std::int64_t> stamps,
                      std::span<const std::span<const double>> channels);
  [[nodiscard]] std::uint64_t samples() const {
    return static_cast<std::uint64_t>(totals_.n) + samples_.filled;
  }
  [[nodiscard]] Expected<std::vector<SineFit>> fit(std::int64_t phase_origin_ns);
  [[nodiscard]] Expected<FrequencyFit> fit_with_frequency(double search_rel,
                                                          std::int64_t phase_origin_ns);

private:
  [[nodiscard]] Expected<void> check(std::span<const std::int64_t> stamps,
                                     std::span<const std::span<const double>> channels) const;
  [[nodiscard]] Expected<void> ready(std::size_t parameters) const;
  [[nodiscard]] Expected<std::int64_t> shift_to(std::int64_t phase_origin_ns) const;
  [[nodiscard]] const kernel::Totals& totals_with_open_block();
  [[nodiscard]] std::size_t without_gap(std::span<const std::int64_t> stamps);
  void prepare_block();
  void close_block();
  void reduce_piece();
  void choose_start();
  [[nodiscard]] double span_s() const { return static_cast<double>(last_ns_ - first_ns_) * 1e-9; }
  [[nodiscard]] std::vector<kernel::Segment> segments_with(kernel::Block& last);
  [[nodiscard]] double max_half_length_s(const kernel::Block& last) const;
  [[nodiscard]] bool is_any_significant(const kernel::FrequencySolution& solution,
                                        const Frequency& frequency, double tries) const;
  [[nodiscard]] double search(std::span<const kernel::Segment> segments, double half_range) const;
  void add_spectra(std::span<const kernel::Segment> segments, double step, int half,
                   std::vector<double>& merit) const;
  [[nodiscard]] double misfit(std::span<const kernel::Segment> segments, double delta,
                              kernel::ShiftedSums& sums) const;

  Frequency frequency_;
  kernel::BlockSamples samples_; // of the open block
  kernel::BlockSamples full_;    // of the last closed one, until its series is there
  kernel::BlockReduction reduction_;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::int64_t last_interval_ns_ = std::numeric_limits<std::int64_t>::max();
  std::vector<kernel::Parameters> start_; // about the first stamp
  kernel::Totals totals_;
  std::deque<kernel::Block>
      blocks_; // closed_ of them, and perhaps one whose memory is ready for the open block
  std::size_t closed_ = 0;
  double max_rate_hz_ = 0.0; // mean of a block

  // Where a result is put together, so that it needs no fresh memory.
  struct OpenBlock {
    explicit OpenBlock(std::size_t channels)
        : start(channels), values(channels), residuals(channels) {}
    kernel::Totals totals;
    std::vector<kernel::Parameters> start;
    std::vector<const double*> values;
    std::vector<kernel::ResidualSums> residuals;
  };
  OpenBlock open_;
};

} // namespace dyncal::analysis
