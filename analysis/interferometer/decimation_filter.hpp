// A low-pass filter that keeps every D-th value: the whole record is used, and only as many values
// are left as a sine fit needs.
//
// Kaiser window (beta 7) of 8 D + 1 coefficients, cut-off 0.45 of the new rate, symmetric: no phase
// but a delay of whole samples, which is taken off. Output m belongs to the instant of input
// first_sample() + m D. Above 512 the factor is split between two such filters (and rounded down to
// a product). The gain at any frequency is known exactly; what is beyond 0.75 of the new rate is
// down by 70 dB. Values that the filter would need from outside the record are not made up: the
// record loses first_sample() samples at either end.
//
// Where the frequency is not known beforehand, and so no gain can be taken off, PassBand::flat is
// longer (20 D + 1, beta 16, cut-off 0.4): its gain is 1 within 2e-7 up to 0.15 of the new rate.
//
// Samples come in blocks of any size; the result does not depend on how they are cut. No
// synchronisation.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dyncal::analysis {

enum class PassBand { short_filter, flat };

inline constexpr double flat_pass_band = 0.15; // of the new rate

class DecimationFilter {
public:
  // REQUIRES: factor >= 1; 1 lets everything through as it is.
  explicit DecimationFilter(std::size_t factor, PassBand pass_band = PassBand::short_filter);

  // Appends to `decimated`.
  void push(std::span<const double> values, std::vector<double>& decimated);

  [[nodiscard]] std::size_t factor() const;
  [[nodiscard]] std::size_t first_sample() const;
  // At a frequency in cycles per sample of the input.
  [[nodiscard]] double gain(double cycles_per_sample) const;

private:
  struct Stage {
    std::size_t factor = 1;
    std::vector<double> coefficients; // 8 factor + 1, or 20 factor + 1
    std::vector<double> kept;         // from the first sample that the next value needs
    std::size_t skipped = 0;          // of the samples to come, which no value needs
  };
  static Stage stage_of(std::size_t factor, PassBand pass_band);
  static void push_through(Stage& stage, std::span<const double> values,
                           std::vector<double>& decimated);

  std::vector<Stage> stages_;
  std::vector<double> between_;
};

} // namespace dyncal::analysis
