#include "analysis/sine/disturbances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "analysis/sine/drift_order.hpp"
#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_solve.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr int max_harmonic = 10;
constexpr std::size_t mains_multiples = 3;
constexpr double usable_part_of_rate = 0.45;
constexpr double min_distance = 1.5; // in 1 / T
constexpr double significant = 4.5;  // standard uncertainties

// The record, as far as it decides what can be looked for.
struct Extent {
  double duration_s;
  double rate_hz;

  explicit Extent(std::span<const std::int64_t> stamps_ns)
      : duration_s(static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9),
        rate_hz(static_cast<double>(stamps_ns.size() - 1) / duration_s) {}

  [[nodiscard]] bool can_show(double line_hz) const {
    return line_hz < usable_part_of_rate * rate_hz;
  }
  // A line of the mains, and far enough from the harmonics of f.
  [[nodiscard]] bool can_tell_hum(double line_hz, double f) const {
    const double distance = std::abs(line_hz - f * std::max(1.0, std::round(line_hz / f)));
    return can_show(line_hz) && distance * duration_s > min_distance;
  }
};

ResidualSearch search_of(const Frequency& frequency, const Extent& extent,
                         std::span<const double> mains_hz) {
  ResidualSearch search{.first = {frequency, 2, max_harmonic - 1}};
  for (const double mains : mains_hz) {
    for (std::size_t k = 1; k <= mains_multiples; ++k) {
      if (extent.can_tell_hum(static_cast<double>(k) * mains, frequency.hz())) {
        search.others.push_back({Frequency::from_hz(mains), 1, mains_multiples});
        break;
      }
    }
  }
  return search;
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

  // Takes the line away.
  void remove(std::complex<double> phasor, double* values) const {
    for (std::size_t i = 0; i < samples_; ++i) {
      values[i] = values[i] - phasor.real() * sine_[i] - phasor.imag() * cosine_[i];
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

bool stands_out(const std::optional<ResidualLine>& line) {
  return line && line->fit.amplitude() > significant * line->fit.u_amplitude();
}

// What the lines of a channel say is to be fitted beside the signal.
ExtendedBasis basis_of(const ResidualSearch& search, const ChannelResiduals& residuals,
                       const Frequency& frequency, const Extent& extent) {
  ExtendedBasis basis;
  const auto& harmonics = residuals.lines.front();
  for (std::size_t k = 0; k < harmonics.size(); ++k) {
    const int order = search.first.first_order + static_cast<int>(k);
    if (extent.can_show(order * frequency.hz()) && stands_out(harmonics[k])) {
      basis.max_harmonic = order;
    }
  }
  const auto is_known = [&](double line_hz) {
    return std::any_of(basis.lines.begin(), basis.lines.end(), [&](const Frequency& other) {
      return std::abs(other.hz() - line_hz) * extent.duration_s < min_distance;
    });
  };
  // Low multiples first: three times 16.7 Hz is beside 50 Hz, which is the more likely.
  for (std::size_t k = 0; k < mains_multiples; ++k) {
    for (std::size_t set = 0; set < search.others.size(); ++set) {
      const LineSet& mains = search.others[set];
      const double line_hz = (mains.first_order + static_cast<int>(k)) * mains.frequency.hz();
      if (extent.can_tell_hum(line_hz, frequency.hz()) && !is_known(line_hz) &&
          stands_out(residuals.lines[set + 1][k])) {
        basis.lines.push_back(Frequency::from_hz(line_hz));
      }
    }
  }
  return basis;
}

struct Disturbances { // of one channel
  PlainChannel plain;
  ExtendedBasis basis;
  DriftEvidence drift;
};

// `fits` about the middle of the record.
Expected<std::vector<Disturbances>>
search_residuals(const Frequency& frequency, std::span<const std::int64_t> stamps_ns,
                 std::span<const std::span<const double>> channels,
                 const std::vector<SineFit>& fits, std::span<const double> mains_hz) {
  const Extent extent(stamps_ns);
  ResidualSearch search = search_of(frequency, extent, mains_hz);
  auto residuals = reduce_residuals(search, stamps_ns, channels, fits);
  DYNCAL_TRY(residuals);
  std::vector<Disturbances> found(channels.size());
  std::vector<std::span<const double>> drifts;
  bool any_drift = false;
  for (std::size_t j = 0; j < channels.size(); ++j) {
    const ChannelResiduals& own = (*residuals)[j];
    found[j].drift = find_drift(frequency.hz() * extent.duration_s, own.time);
    found[j].plain = plain_channel(fits[j], search.first, own);
    drifts.push_back(found[j].drift.polynomial());
    any_drift |= !drifts.back().empty();
  }
  if (any_drift) { // lines show better without it
    search.drifts = drifts;
    residuals = reduce_residuals(search, stamps_ns, channels, fits);
    DYNCAL_TRY(residuals);
  }
  for (std::size_t j = 0; j < channels.size(); ++j) {
    found[j].basis = basis_of(search, (*residuals)[j], frequency, extent);
  }
  return found;
}

std::vector<SineFit> about_middle(std::vector<SineFit> fits, const Frequency& frequency,
                                  std::int64_t phase_origin_ns,
                                  std::span<const std::int64_t> stamps_ns) {
  const double turns = frequency.reduced_turns(middle_of_record_ns(stamps_ns) - phase_origin_ns);
  for (SineFit& fit : fits) {
    kernel::rotate(fit, turns);
  }
  return fits;
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
      block.remove(about_first, result.values.data() + first);
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

// What all channels show beside a sine of one frequency, before it is taken out.
struct Examination {
  std::vector<SineFit> plain; // about the phase origin
  std::vector<Disturbances> found;
};

Expected<Examination> examine(const Frequency& frequency, std::int64_t phase_origin_ns,
                              std::span<const std::int64_t> stamps_ns,
                              std::span<const std::span<const double>> channels,
                              std::span<const double> mains_hz) {
  DYNCAL_TRY(auto plain, fit_sine(frequency, phase_origin_ns, stamps_ns, channels));
  DYNCAL_TRY(auto found, search_residuals(
                             frequency, stamps_ns, channels,
                             about_middle(plain, frequency, phase_origin_ns, stamps_ns), mains_hz));
  return Examination{std::move(plain), std::move(found)};
}

// One of the channels beside what was found in it.
CleanedFit clean(const Frequency& frequency, const Examination& examined, std::size_t channel,
                 std::int64_t phase_origin_ns, std::span<const std::int64_t> stamps_ns,
                 std::span<const double> values) {
  const Disturbances& found = examined.found[channel];
  CleanedFit result;
  result.fit = examined.plain[channel];
  result.plain = found.plain;
  const auto chosen = choose_drift_order(frequency, found.basis, found.drift, result.fit,
                                         phase_origin_ns, stamps_ns, values);
  if (chosen.model) {
    remove_disturbances(result, frequency, *chosen.model, phase_origin_ns, stamps_ns, values);
  }
  add_undetected_drift(chosen, result.fit);
  return result;
}

// Rounds of fitting the frequency and what is beside it in turn. Of n steps, each is r times the
// one before it, where r is the square of the correlation of the two: so r / (1 - r) of the last
// step is still to go, and u of one that is fitted alone is to be divided by sqrt(1 - r). Few
// periods beside a drift have an r of a half and more.
class Rounds {
public:
  void step(double hz, double u_hz) {
    const double before = last_hz_;
    last_hz_ = hz;
    u_hz_ = u_hz;
    const bool tells = std::abs(before) > told_by * u_hz;
    r_ = count_ > 0 && tells ? std::clamp(hz / before, 0.0, largest_r) : 0.0;
    ++count_;
  }

  [[nodiscard]] bool enough() const {
    const double left_hz = std::abs(last_hz_) * std::max(1.0, r_ / (1.0 - r_));
    return left_hz < negligible * u_hz_ || count_ == most;
  }

  [[nodiscard]] double widening() const { return 1.0 / std::sqrt(1.0 - r_); }

private:
  static constexpr int most = 40;            // 0.9^40 = 0.01
  static constexpr double largest_r = 0.99;  // u is ten times larger
  static constexpr double negligible = 0.01; // of u
  static constexpr double told_by = 1e-3;    // of u: smaller steps are of rounding and choices
  int count_ = 0;
  double last_hz_ = 0.0, u_hz_ = 0.0, r_ = 0.0;
};

// The frequency on the channels without what was taken out of them; `fit` and `undisturbed` are of
// the same frequency. Each round's disturbances are those at the frequency of the last.
Expected<FrequencyFit> refine_frequency(FrequencyFit fit, std::vector<CleanedFit> undisturbed,
                                        double search_rel, std::int64_t phase_origin_ns,
                                        std::span<const std::int64_t> stamps_ns,
                                        std::span<const std::span<const double>> channels,
                                        std::span<const double> mains_hz) {
  Rounds rounds;
  while (true) {
    std::vector<std::span<const double>> cleaned(channels.begin(), channels.end());
    bool any = false;
    for (std::size_t j = 0; j < channels.size(); ++j) {
      if (!undisturbed[j].values.empty()) {
        cleaned[j] = undisturbed[j].values;
        any = true;
      }
    }
    if (!any) {
      return fit;
    }
    auto refined =
        fit_sine_and_frequency(fit.frequency, search_rel, phase_origin_ns, stamps_ns, cleaned);
    if (!refined) {
      return refined;
    }
    rounds.step(refined->frequency.hz() - fit.frequency.hz(), refined->u_frequency_hz);
    fit = std::move(*refined);
    if (rounds.enough()) {
      fit.u_frequency_hz *= rounds.widening();
      return fit;
    }
    DYNCAL_TRY(undisturbed, fit_sine_beside_disturbances(fit.frequency, phase_origin_ns, stamps_ns,
                                                         channels, mains_hz));
  }
}

} // namespace

Expected<std::vector<CleanedFit>>
fit_sine_beside_disturbances(const Frequency& frequency, std::int64_t phase_origin_ns,
                             std::span<const std::int64_t> stamps_ns,
                             std::span<const std::span<const double>> channels,
                             std::span<const double> mains_hz) {
  DYNCAL_TRY(const auto examined,
             examine(frequency, phase_origin_ns, stamps_ns, channels, mains_hz));
  std::vector<CleanedFit> result;
  for (std::size_t j = 0; j < channels.size(); ++j) {
    result.push_back(clean(frequency, examined, j, phase_origin_ns, stamps_ns, channels[j]));
  }
  return result;
}

Expected<FrequencyFit> fit_frequency_beside_disturbances(
    const Frequency& start, double search_rel, std::int64_t phase_origin_ns,
    std::span<const std::int64_t> stamps_ns, std::span<const std::span<const double>> channels,
    std::span<const double> mains_hz) {
  auto fit = fit_sine_and_frequency(start, search_rel, phase_origin_ns, stamps_ns, channels);
  if (!fit) {
    return fit;
  }
  DYNCAL_TRY(auto undisturbed, fit_sine_beside_disturbances(fit->frequency, phase_origin_ns,
                                                            stamps_ns, channels, mains_hz));
  return refine_frequency(std::move(*fit), std::move(undisturbed), search_rel, phase_origin_ns,
                          stamps_ns, channels, mains_hz);
}

Expected<PilotFit> fit_pilot_beside_disturbances(const Frequency& start, double search_rel,
                                                 std::int64_t phase_origin_ns,
                                                 std::span<const std::int64_t> stamps_ns,
                                                 std::span<const std::span<const double>> channels,
                                                 std::span<const double> mains_hz) {
  const auto pilot = channels.first(1);
  DYNCAL_TRY(auto fit,
             fit_sine_and_frequency(start, search_rel, phase_origin_ns, stamps_ns, pilot));
  auto examined = examine(fit.frequency, phase_origin_ns, stamps_ns, channels, mains_hz);
  if (!examined) { // perhaps because of another channel
    examined = examine(fit.frequency, phase_origin_ns, stamps_ns, pilot, mains_hz);
  }
  DYNCAL_TRY(examined);
  std::vector<CleanedFit> cleaned{
      clean(fit.frequency, *examined, 0, phase_origin_ns, stamps_ns, pilot.front())};
  if (!cleaned.front().values.empty()) {
    return refine_frequency(std::move(fit), std::move(cleaned), search_rel, phase_origin_ns,
                            stamps_ns, pilot, mains_hz)
        .map([](const FrequencyFit& refined) {
          return PilotFit{refined.frequency, refined.u_frequency_hz, {}};
        });
  }
  if (examined->found.size() < channels.size()) {
    cleaned.clear();
  }
  for (std::size_t j = 1; j < examined->found.size(); ++j) {
    cleaned.push_back(clean(fit.frequency, *examined, j, phase_origin_ns, stamps_ns, channels[j]));
  }
  return PilotFit{fit.frequency, fit.u_frequency_hz, std::move(cleaned)};
}

} // namespace dyncal::analysis
