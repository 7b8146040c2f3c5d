#include "analysis/sine/drift_order.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double price = 10.0;         // gain that one more order has to bring
constexpr double few_periods = 12.0;   // below, the orders are fitted in full
constexpr double worth_a_look = 0.5;   // of the price, by the projections
constexpr double worth_stating = 0.05; // probability of the next order
constexpr std::size_t orders = max_drift_order + 1;

struct UnitTime { // u
  double middle_ns, inverse_half_ns;
  std::int64_t first_ns;

  explicit UnitTime(std::span<const std::int64_t> stamps_ns)
      : middle_ns(0.5 * static_cast<double>(stamps_ns.back() - stamps_ns.front())),
        inverse_half_ns(middle_ns > 0.0 ? 1.0 / middle_ns : 0.0), first_ns(stamps_ns.front()) {}
  [[nodiscard]] double at(std::int64_t stamp_ns) const {
    return (static_cast<double>(stamp_ns - first_ns) - middle_ns) * inverse_half_ns;
  }
};

// Coefficients of powers from those of Legendre's polynomials.
std::array<double, orders> to_powers(const std::array<double, orders>& c) {
  return {c[0] - 0.5 * c[2], c[1] - 1.5 * c[3], 1.5 * c[2], 2.5 * c[3]};
}

std::size_t best_order(const std::array<double, orders>& gain) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < orders; ++k) {
    if (gain[k] - price * static_cast<double>(k) > gain[best] - price * static_cast<double>(best)) {
      best = k;
    }
  }
  return best;
}

// The plain model as an extended fit, so that all orders are compared alike.
ExtendedFit as_extended(const SineFit& plain) {
  ExtendedFit fit;
  fit.fundamental = plain;
  return fit;
}

struct Orders {
  std::array<std::optional<ExtendedFit>, orders> fits;
  std::array<double, orders> gain{};
};

double gain_of(const SineFit& without, const SineFit& with) {
  const double variance = with.rss / std::max(1.0, with.degrees_of_freedom);
  return variance > 0.0 ? (without.rss - with.rss) / variance : 0.0;
}

} // namespace

std::span<const double> DriftEvidence::polynomial() const {
  return std::span(powers).subspan(1, static_cast<std::size_t>(order));
}

DriftEvidence find_drift(double periods, const TimeSums& residuals) {
  // Products of the residuals with Legendre's polynomials, and their squares.
  const auto& [eu0, eu1, eu2, eu3] = residuals.eu;
  const auto& u = residuals.u;
  const std::array<double, orders> projection{eu0, eu1, 1.5 * eu2 - 0.5 * eu0,
                                              2.5 * eu3 - 1.5 * eu1};
  const std::array<double, orders> squares{u[0], u[2], 2.25 * u[4] - 1.5 * u[2] + 0.25 * u[0],
                                           6.25 * u[6] - 7.5 * u[4] + 2.25 * u[2]};
  std::array<double, orders> gain{}, coefficients{};
  double explained = 0.0;
  for (std::size_t k = 1; k < orders; ++k) {
    coefficients[k] = squares[k] > 0.0 ? projection[k] / squares[k] : 0.0;
    explained += coefficients[k] * projection[k];
    const double variance = (residuals.ee - explained) /
                            std::max(1.0, residuals.samples - 3.0 - static_cast<double>(k));
    gain[k] = variance > 0.0 ? explained / variance : 0.0;
  }
  DriftEvidence result;
  const std::size_t best = best_order(gain);
  result.order = static_cast<int>(best);
  std::fill(coefficients.begin() + static_cast<std::ptrdiff_t>(best) + 1, coefficients.end(), 0.0);
  result.powers = to_powers(coefficients);
  result.decided = periods >= few_periods && best == 0;
  for (std::size_t k = 1; k < orders; ++k) {
    result.decided &= gain[k] < worth_a_look * price * static_cast<double>(k);
  }
  return result;
}

void remove_drift(std::span<const double> powers, std::span<const std::int64_t> stamps_ns,
                  std::span<double> values) {
  if (powers.empty()) {
    return;
  }
  const UnitTime time(stamps_ns);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double u = time.at(stamps_ns[i]);
    double sum = 0.0;
    for (std::size_t k = powers.size(); k-- > 0;) {
      sum = (sum + powers[k]) * u;
    }
    values[i] -= sum;
  }
}

DriftChoice choose_drift_order(const Frequency& frequency, const ExtendedBasis& beside,
                               const DriftEvidence& evidence, const SineFit& plain,
                               std::int64_t phase_origin_ns,
                               std::span<const std::int64_t> stamps_ns,
                               std::span<const double> values) {
  const bool alone = beside.max_harmonic <= 1 && beside.lines.empty();
  const auto fit_order = [&](int order) -> std::optional<ExtendedFit> {
    if (order == 0 && alone) {
      return as_extended(plain);
    }
    ExtendedBasis basis = beside;
    basis.drift_order = order;
    const std::span<const double> channel[] = {values};
    auto fit =
        fit_sine_extended(frequency, basis, Weighting::none, phase_origin_ns, stamps_ns, channel);
    return fit ? std::optional(std::move(fit->front())) : std::nullopt;
  };
  Orders tried;
  tried.fits[0] = fit_order(0);
  DriftChoice choice;
  if (evidence.decided || !tried.fits[0]) {
    if (!alone) {
      choice.model = std::move(tried.fits[0]);
    }
    return choice;
  }
  for (std::size_t k = 1; k < orders; ++k) {
    tried.fits[k] = fit_order(static_cast<int>(k));
    if (!tried.fits[k]) {
      break;
    }
    tried.gain[k] = gain_of(tried.fits[0]->fundamental, tried.fits[k]->fundamental);
  }
  const std::size_t best = best_order(tried.gain);
  const SineFit chosen = tried.fits[best]->fundamental;
  if (best + 1 < orders && tried.fits[best + 1]) {
    const SineFit& next = tried.fits[best + 1]->fundamental;
    const double w = 1.0 / (1.0 + std::exp(0.5 * (price - gain_of(chosen, next))));
    if (w > worth_stating) {
      choice.probability = w;
      choice.change = {next.sine - chosen.sine, next.cosine - chosen.cosine};
    }
  }
  if (best > 0 || !alone) {
    choice.model = std::move(tried.fits[best]);
  }
  return choice;
}

void add_undetected_drift(const DriftChoice& choice, SineFit& fit) {
  const double part = choice.probability * (1.0 - choice.probability);
  fit.covariance[0] += part * choice.change.real() * choice.change.real();
  fit.covariance[1] += part * choice.change.real() * choice.change.imag();
  fit.covariance[3] += part * choice.change.imag() * choice.change.imag();
}

} // namespace dyncal::analysis
