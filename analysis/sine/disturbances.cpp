#include "analysis/sine/disturbances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "analysis/sine/drift_order.hpp"
#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr int max_harmonic = 10;
constexpr std::array mains_hz{50.0, 100.0, 150.0, 60.0, 120.0, 180.0};
constexpr double usable_part_of_rate = 0.45;
constexpr double min_distance = 1.5; // in 1 / T
constexpr double significant = 4.5;  // standard uncertainties

struct Candidate {
  Frequency frequency;
  int harmonic; // 0: a line of the mains
};

std::vector<Candidate> candidates(const Frequency& frequency, double rate_hz, double duration_s) {
  std::vector<Candidate> result;
  const double f = frequency.hz();
  for (int k = 2; k <= max_harmonic && k * f < usable_part_of_rate * rate_hz; ++k) {
    result.push_back({frequency.shifted_by_hz((k - 1) * f), k});
  }
  for (const double line : mains_hz) {
    const double distance = std::abs(line - f * std::max(1.0, std::round(line / f)));
    if (line < usable_part_of_rate * rate_hz && distance * duration_s > min_distance) {
      result.push_back({Frequency::from_hz(line), 0});
    }
  }
  return result;
}

// Sine and cosine of a frequency for some samples at a time, so that they stay in the cache.
class SineBlock {
public:
  static constexpr std::size_t max_samples = 512;

  // About `origin_ns`. REQUIRES: at most `max_samples`.
  void fill(const Frequency& frequency, std::int64_t origin_ns,
            std::span<const std::int64_t> stamps_ns) {
    samples_ = stamps_ns.size();
    fill_sine_cosine(frequency, origin_ns, stamps_ns, sine_.data(), cosine_.data());
  }

  // Leaves in `to` the values less offset and line; they may be the same.
  void remove(std::complex<double> phasor, double offset, const double* values, double* to) const {
    for (std::size_t i = 0; i < samples_; ++i) {
      to[i] = values[i] - offset - phasor.real() * sine_[i] - phasor.imag() * cosine_[i];
    }
  }

private:
  std::array<double, max_samples> sine_, cosine_;
  std::size_t samples_ = 0;
};

// The phasor about another instant.
std::complex<double> turned(const Frequency& frequency, std::complex<double> phasor,
                            std::int64_t by_ns) {
  const double angle = 2.0 * std::numbers::pi * frequency.reduced_turns(by_ns);
  return phasor * std::complex<double>(std::cos(angle), std::sin(angle));
}

// Calls with the first index of every stretch of samples that a SineBlock holds, and their number.
template <class Visit>
void for_each_block(std::size_t samples, Visit visit) {
  for (std::size_t i = 0; i < samples; i += SineBlock::max_samples) {
    visit(i, std::min(SineBlock::max_samples, samples - i));
  }
}

// The channels without the sine that was fitted and the offset, one after the other.
std::unique_ptr<double[]> residuals_of(const Frequency& frequency, std::int64_t phase_origin_ns,
                                       std::span<const std::int64_t> stamps_ns,
                                       std::span<const std::span<const double>> channels,
                                       const std::vector<SineFit>& fits) {
  auto residuals = std::make_unique_for_overwrite<double[]>(channels.size() * stamps_ns.size());
  std::vector<std::complex<double>> phasors;
  phasors.reserve(fits.size());
  for (const SineFit& fit : fits) {
    phasors.push_back(
        turned(frequency, {fit.sine, fit.cosine}, stamps_ns.front() - phase_origin_ns));
  }
  SineBlock block;
  for_each_block(stamps_ns.size(), [&](std::size_t first, std::size_t n) {
    block.fill(frequency, stamps_ns.front(), stamps_ns.subspan(first, n));
    for (std::size_t j = 0; j < channels.size(); ++j) {
      block.remove(phasors[j], fits[j].offset, channels[j].data() + first,
                   residuals.get() + j * stamps_ns.size() + first);
    }
  });
  return residuals;
}

struct Disturbances { // of one channel
  ExtendedBasis basis;
  DriftEvidence drift;
};

std::vector<Disturbances> search(const Frequency& frequency, std::int64_t phase_origin_ns,
                                 std::span<const std::int64_t> stamps_ns,
                                 std::span<const std::span<const double>> channels,
                                 const std::vector<SineFit>& fits) {
  std::vector<Disturbances> found(channels.size());
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double rate_hz = static_cast<double>(stamps_ns.size() - 1) / duration_s;
  const std::unique_ptr<double[]> residuals =
      residuals_of(frequency, phase_origin_ns, stamps_ns, channels, fits);
  std::vector<std::span<const double>> residual_channels;
  for (std::size_t j = 0; j < channels.size(); ++j) {
    const std::span<double> own(residuals.get() + j * stamps_ns.size(), stamps_ns.size());
    found[j].drift = find_drift(frequency, stamps_ns, own);
    remove_drift(found[j].drift.polynomial(), stamps_ns, own);
    residual_channels.emplace_back(own);
  }

  for (const Candidate& candidate : candidates(frequency, rate_hz, duration_s)) {
    const auto lines = fit_sine(candidate.frequency, phase_origin_ns, stamps_ns, residual_channels);
    if (!lines) {
      continue; // such a line cannot be told from a constant in this record
    }
    for (std::size_t j = 0; j < channels.size(); ++j) {
      const SineFit& line = (*lines)[j];
      if (!(line.amplitude() > significant * line.u_amplitude())) {
        continue;
      }
      if (candidate.harmonic > 0) {
        found[j].basis.max_harmonic = candidate.harmonic;
      } else {
        found[j].basis.lines.push_back(candidate.frequency);
      }
    }
  }
  return found;
}

void remove_disturbances(CleanedFit& result, const Frequency& frequency, const ExtendedFit& fit,
                         std::int64_t phase_origin_ns, std::span<const std::int64_t> stamps_ns,
                         std::span<const double> values) {
  result.fit = fit.fundamental;
  result.values.assign(values.begin(), values.end());
  SineBlock block;
  const auto take = [&](const Frequency& line, const FurtherPhasor& phasor) {
    const std::complex<double> about_first =
        turned(line, {phasor.sine, phasor.cosine}, stamps_ns.front() - phase_origin_ns);
    for_each_block(stamps_ns.size(), [&](std::size_t first, std::size_t n) {
      block.fill(line, stamps_ns.front(), stamps_ns.subspan(first, n));
      block.remove(about_first, 0.0, result.values.data() + first, result.values.data() + first);
    });
    result.removed_hz.push_back(line.hz());
  };
  for (std::size_t k = 0; k < fit.harmonics.size(); ++k) {
    take(frequency.shifted_by_hz(static_cast<double>(k + 1) * frequency.hz()), fit.harmonics[k]);
  }
  for (const FurtherPhasor& line : fit.lines) {
    take(Frequency::from_hz(line.frequency_hz), line);
  }
  remove_drift(fit.drift, stamps_ns, result.values);
  result.drift_order = static_cast<int>(fit.drift.size());
}

} // namespace

Expected<std::vector<CleanedFit>>
fit_sine_beside_disturbances(const Frequency& frequency, std::int64_t phase_origin_ns,
                             std::span<const std::int64_t> stamps_ns,
                             std::span<const std::span<const double>> channels) {
  const auto plain = fit_sine(frequency, phase_origin_ns, stamps_ns, channels);
  if (!plain) {
    return fail(plain.error());
  }
  const std::vector<Disturbances> found =
      search(frequency, phase_origin_ns, stamps_ns, channels, *plain);
  std::vector<CleanedFit> result(channels.size());
  for (std::size_t j = 0; j < channels.size(); ++j) {
    result[j].fit = (*plain)[j];
    const auto chosen = choose_drift_order(frequency, found[j].basis, found[j].drift, (*plain)[j],
                                           phase_origin_ns, stamps_ns, channels[j]);
    if (chosen.model) {
      remove_disturbances(result[j], frequency, *chosen.model, phase_origin_ns, stamps_ns,
                          channels[j]);
    }
    add_undetected_drift(chosen, result[j].fit);
  }
  return result;
}

Expected<FrequencyFit> fit_frequency_beside_disturbances(
    const Frequency& start, double search_rel, std::int64_t phase_origin_ns,
    std::span<const std::int64_t> stamps_ns, std::span<const std::span<const double>> channels) {
  constexpr int max_rounds = 3; // each round's disturbances are those at the frequency of the last
  auto fit = fit_sine_and_frequency(start, search_rel, phase_origin_ns, stamps_ns, channels);
  for (int round = 0; fit && round < max_rounds; ++round) {
    const auto undisturbed =
        fit_sine_beside_disturbances(fit->frequency, phase_origin_ns, stamps_ns, channels);
    if (!undisturbed) {
      return fail(undisturbed.error());
    }
    std::vector<std::span<const double>> cleaned(channels.begin(), channels.end());
    bool any = false;
    for (std::size_t j = 0; j < channels.size(); ++j) {
      if (!(*undisturbed)[j].values.empty()) {
        cleaned[j] = (*undisturbed)[j].values;
        any = true;
      }
    }
    if (!any) {
      break;
    }
    const double before_hz = fit->frequency.hz();
    fit = fit_sine_and_frequency(fit->frequency, search_rel, phase_origin_ns, stamps_ns, cleaned);
    if (fit && std::abs(fit->frequency.hz() - before_hz) < 0.01 * fit->u_frequency_hz) {
      break;
    }
  }
  return fit;
}

} // namespace dyncal::analysis
