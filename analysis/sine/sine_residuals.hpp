// What a sine that was fitted to some channels leaves of them, from one pass over their samples:
// drift, harmonics, other lines, and the values themselves in blocks.
//
//   e = y - A sin - B cos - C - d_1 u - d_2 u^2 ...     u = -1 .. 1 over the record
//
// One sine and cosine a sample serve all channels, and those of multiples follow from them. Each
// line is fitted to the residuals with a constant, as fit_sine() does; there is none where it
// cannot be told from the constant. Phases are about the middle of the record. The drift (d) is
// taken away where one is given.
//
// REQUIRES: stamps and channels that were fitted, so they increase and are finite. Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/sine/sine_fit.hpp"

namespace dyncal::analysis {

// Multiples first_order, first_order + 1, ... of a frequency. REQUIRES: `orders` a multiple of
// three.
struct LineSet {
  Frequency frequency;
  int first_order = 1;
  int orders = 3;
};

// Sums of the residuals and of the time over the record.
struct TimeSums {
  double samples = 0.0;
  std::array<double, 7> u{};  // sum of u^0 .. u^6
  std::array<double, 4> eu{}; // sum of e u^0 .. e u^3
  double ee = 0.0;
};

struct ResidualLine {
  SineFit fit;       // about the middle of the record
  double gain = 0.0; // by how much it lowers the sum of squares
};

// The range of values of `value_block_samples` samples, the last of them fewer.
inline constexpr std::size_t value_block_samples = 512;
struct ValueBlock {
  double low = 0.0;
  double high = 0.0;
  bool repeats = false; // two neighbours in it are equal
};

struct ChannelResiduals {
  TimeSums time;
  std::vector<std::vector<std::optional<ResidualLine>>> lines; // by set, then by order
  std::vector<ValueBlock> blocks;
};

// `first` of the sets is of the fitted frequency, and is always looked at; `others` beside it.
struct ResidualSearch {
  LineSet first;
  std::vector<LineSet> others{};
  std::span<const std::span<const double>> drifts{}; // powers u^1 .. of each channel; may be empty
};

// `fits` about the middle of the record.
[[nodiscard]] Expected<std::vector<ChannelResiduals>>
reduce_residuals(const ResidualSearch& search, std::span<const std::int64_t> stamps_ns,
                 std::span<const std::span<const double>> channels, std::span<const SineFit> fits);

// A channel as its samples came: the sine that was fitted to it alone, and what else is in it.
struct HarmonicLine {
  int order = 2;
  ResidualLine line;
};
struct PlainChannel {
  SineFit fit;                         // about the middle of the record
  std::vector<HarmonicLine> harmonics; // in rising order, without those that no line can show
  std::vector<ValueBlock> blocks;
};
[[nodiscard]] PlainChannel plain_channel(const SineFit& fit, const LineSet& harmonics,
                                         const ChannelResiduals& residuals);

// REQUIRES: at least two samples.
[[nodiscard]] std::int64_t middle_of_record_ns(std::span<const std::int64_t> stamps_ns);

} // namespace dyncal::analysis
