#include "analysis/disturbances.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/sine_fit_extended.hpp"
#include "analysis/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr int highest_harmonic = 10;
constexpr std::array mains_hz{50.0, 100.0, 150.0, 60.0, 120.0, 180.0};
constexpr double usable_part_of_rate = 0.45;
constexpr double least_distance = 1.5; // in 1 / T
constexpr double significant = 4.5;    // standard uncertainties

struct Candidate {
  Frequency frequency;
  int harmonic; // 0: a line of the mains
};

std::vector<Candidate> candidates(const Frequency& frequency, double rate_hz, double duration_s) {
  std::vector<Candidate> result;
  const double f = frequency.hz();
  for (int k = 2; k <= highest_harmonic && k * f < usable_part_of_rate * rate_hz; ++k)
    result.push_back({frequency.shifted_by_hz((k - 1) * f), k});
  for (const double line : mains_hz) {
    const double distance = std::abs(line - f * std::max(1.0, std::round(line / f)));
    if (line < usable_part_of_rate * rate_hz && distance * duration_s > least_distance) result.push_back({Frequency::from_hz(line), 0});
  }
  return result;
}

// A frequency's sine and cosine at all stamps, phases about the first one.
class Line {
public:
  Line(const Frequency& frequency, std::int64_t reference_ns, std::span<const std::int64_t> stamps_ns)
      : sine_(stamps_ns.size()), cosine_(stamps_ns.size()) {
    fill_sine_cosine(frequency, stamps_ns.front(), stamps_ns, sine_.data(), cosine_.data());
    const double angle = 2.0 * std::numbers::pi * frequency.reduced_turns(stamps_ns.front() - reference_ns);
    turn_ = {std::cos(angle), std::sin(angle)};
  }

  // The values less the line and the offset; sine and cosine about the reference instant.
  [[nodiscard]] std::vector<double> removed_from(std::span<const double> values, double sine, double cosine, double offset) const {
    const std::complex<double> p = std::complex<double>(sine, cosine) * turn_;
    std::vector<double> result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      result[i] = values[i] - offset - p.real() * sine_[i] - p.imag() * cosine_[i];
    return result;
  }

private:
  std::vector<double> sine_, cosine_;
  std::complex<double> turn_;
};

struct Disturbances { // of one channel
  ExtendedBasis basis;
  [[nodiscard]] bool any() const { return basis.highest_harmonic > 1 || !basis.lines.empty(); }
};

std::vector<Disturbances> search(const Frequency& frequency, std::int64_t reference_ns, std::span<const std::int64_t> stamps_ns,
                                 std::span<const std::span<const double>> channels, const std::vector<SineFit>& fits) {
  std::vector<Disturbances> found(channels.size());
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double rate_hz = static_cast<double>(stamps_ns.size() - 1) / duration_s;
  const std::vector<Candidate> tried = candidates(frequency, rate_hz, duration_s);
  if (tried.empty()) return found;
  std::vector<std::vector<double>> residuals;
  std::vector<std::span<const double>> residual_channels;
  const Line fundamental(frequency, reference_ns, stamps_ns);
  for (std::size_t j = 0; j < channels.size(); ++j)
    residuals.push_back(fundamental.removed_from(channels[j], fits[j].sine, fits[j].cosine, fits[j].offset));
  for (const std::vector<double>& residual : residuals)
    residual_channels.push_back(residual);

  for (const Candidate& candidate : tried) {
    const auto lines = fit_sine(candidate.frequency, reference_ns, stamps_ns, residual_channels);
    if (!lines) continue; // such a line cannot be told from a constant in this record
    for (std::size_t j = 0; j < channels.size(); ++j) {
      const SineFit& line = (*lines)[j];
      if (!(line.amplitude() > significant * line.u_amplitude())) continue;
      if (candidate.harmonic > 0)
        found[j].basis.highest_harmonic = candidate.harmonic;
      else
        found[j].basis.lines.push_back(candidate.frequency);
    }
  }
  return found;
}

void take_out(UndisturbedFit& result, const Frequency& frequency, const ExtendedFit& fit, std::int64_t reference_ns,
              std::span<const std::int64_t> stamps_ns, std::span<const double> values) {
  result.fit = fit.fundamental;
  result.values.assign(values.begin(), values.end());
  const auto take = [&](const Frequency& line, const FurtherPhasor& phasor) {
    result.values = Line(line, reference_ns, stamps_ns).removed_from(result.values, phasor.sine, phasor.cosine, 0.0);
    result.removed_hz.push_back(line.hz());
  };
  for (std::size_t k = 0; k < fit.harmonics.size(); ++k)
    take(frequency.shifted_by_hz(static_cast<double>(k + 1) * frequency.hz()), fit.harmonics[k]);
  for (const FurtherPhasor& line : fit.lines)
    take(Frequency::from_hz(line.frequency_hz), line);
}

} // namespace

Expected<std::vector<UndisturbedFit>> fit_sine_beside_disturbances(const Frequency& frequency, std::int64_t reference_ns,
                                                                   std::span<const std::int64_t> stamps_ns,
                                                                   std::span<const std::span<const double>> channels) {
  const auto plain = fit_sine(frequency, reference_ns, stamps_ns, channels);
  if (!plain) return tl::unexpected(plain.error());
  const std::vector<Disturbances> found = search(frequency, reference_ns, stamps_ns, channels, *plain);
  std::vector<UndisturbedFit> result(channels.size());
  for (std::size_t j = 0; j < channels.size(); ++j) {
    result[j].fit = (*plain)[j];
    if (!found[j].any()) continue;
    const auto fit = fit_sine_extended(frequency, found[j].basis, Weighting::none, reference_ns, stamps_ns, channels.subspan(j, 1));
    if (fit) take_out(result[j], frequency, fit->front(), reference_ns, stamps_ns, channels[j]);
  }
  return result;
}

} // namespace dyncal::analysis
