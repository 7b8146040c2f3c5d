#include "drivers/interferometer/quadrature_demodulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "analysis/interferometer/radius_over_phase.hpp"

namespace dyncal::drivers::interferometer {
namespace {

constexpr std::size_t chunk = 4096;
constexpr double no_beam_below = 0.2; // of the radius
constexpr double doubtful_turns = 0.25;
constexpr std::uint64_t samples_between_looks = 65536; // at the radius over the phase
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

QuadratureSignals signals_of(const InterferometerSettings& settings) {
  QuadratureSignals signals;
  signals.channel = settings.channel;
  signals.displacement_per_turn_m = settings.displacement_per_turn_m;
  signals.u_wavelength_rel = settings.u_wavelength_rel;
  signals.detector_bandwidth_hz = settings.detector_bandwidth_hz.value_or(0.0);
  signals.u_skew_s = settings.u_skew_s;
  signals.ellipse_from = "no ellipse yet";
  return signals;
}

void describe_ellipse(const analysis::Ellipse& ellipse, QuadratureSignals& signals) {
  signals.centre_u1 = ellipse.p;
  signals.centre_u2 = ellipse.q;
  signals.radius_u1 = ellipse.radius;
  signals.radius_ratio = ellipse.r;
  signals.quadrature_error_rad = ellipse.alpha_rad;
}

std::vector<double> relative(const analysis::RadiusHarmonics& radius) {
  std::vector<double> errors;
  for (const double amplitude : radius.amplitude) {
    errors.push_back(amplitude / radius.mean);
  }
  return errors;
}

bool at_end(double value, const std::optional<analysis::SignalRange>& range) {
  return range && (value <= range->low || value >= range->high);
}

} // namespace

QuadratureDemodulator::QuadratureDemodulator(const InterferometerSettings& settings,
                                             const PairRanges& ranges, double rate_hz)
    : described_(signals_of(settings)), ranges_(ranges), is_stated_(settings.ellipse.has_value()),
      running_(rate_hz) {
  forget_radius();
  begin_again();
  if (settings.ellipse) {
    const StatedEllipse& stated = *settings.ellipse;
    ellipse_ = stated.ellipse;
    phase_.emplace(ellipse_);
    describe_ellipse(ellipse_, described_);
    described_.ellipse_from = stated.from;
    described_.turns_covered = stated.turns_covered;
    described_.u_ellipse_rad.assign(stated.u_rad.begin(), stated.u_rad.end());
    if (stated.periodic_error_rad) {
      described_.periodic_error_rad.assign(stated.periodic_error_rad->begin(),
                                           stated.periodic_error_rad->end());
      periodic_error_stated_ = true;
    }
  }
}

void QuadratureDemodulator::begin_again() {
  before_ = not_a_number;
  last_ = not_a_number;
  running_.reset_window();
  if (phase_) {
    phase_->begin_again();
  }
}

void QuadratureDemodulator::forget_radius() {
  min_radius_squared_ = std::numeric_limits<double>::infinity();
  max_radius_squared_ = 0.0;
}

std::optional<double> QuadratureDemodulator::radius_ratio() const {
  return min_radius_squared_ <= max_radius_squared_
             ? std::optional(std::sqrt(min_radius_squared_ / max_radius_squared_))
             : std::nullopt;
}

std::optional<double> QuadratureDemodulator::radius_over_stated() const {
  return max_radius_squared_ > 0.0 ? std::optional(std::sqrt(max_radius_squared_) / ellipse_.radius)
                                   : std::nullopt;
}

void QuadratureDemodulator::push(std::span<const double> u1, std::span<const double> u2,
                                 std::vector<double>& turns) {
  const std::size_t first = turns.size();
  turns.resize(first + u1.size(), not_a_number);
  for (std::size_t begin = 0; begin < u1.size(); begin += chunk) {
    const std::size_t n = std::min(chunk, u1.size() - begin);
    push_chunk(u1.subspan(begin, n), u2.subspan(begin, n),
               std::span(turns).subspan(first + begin, n));
  }
}

bool QuadratureDemodulator::reaches_end(const analysis::EllipseMoments& sums) const {
  return at_end(sums.range_1().low, ranges_.u1) || at_end(sums.range_1().high, ranges_.u1) ||
         at_end(sums.range_2().low, ranges_.u2) || at_end(sums.range_2().high, ranges_.u2);
}

void QuadratureDemodulator::push_chunk(std::span<const double> u1, std::span<const double> u2,
                                       std::span<double> turns) {
  analysis::EllipseMoments sums;
  sums.add(u1, u2);
  if (!phase_) {
    if (reaches_end(sums) || !std::isfinite(sums.difference_variance_1()) ||
        !std::isfinite(sums.difference_variance_2())) {
      push_faulty(u1, u2, turns);
    } else if (const auto found = running_.add(u1, u2, sums, {})) {
      take(*found); // from the next chunk on
    }
    return;
  }
  const analysis::QuadraturePhase as_it_was = *phase_;
  phase_->forget_extremes();
  const auto pushed = phase_->push(u1, u2, turns);
  const analysis::PhaseStatistics& seen = phase_->statistics();
  const double no_beam = std::pow(no_beam_below * ellipse_.radius, 2);
  if (!pushed || reaches_end(sums) || seen.min_radius_squared < no_beam) {
    phase_ = as_it_was;
    push_faulty(u1, u2, turns);
    return;
  }
  min_radius_squared_ = std::min(min_radius_squared_, seen.min_radius_squared);
  max_radius_squared_ = std::max(max_radius_squared_, seen.max_radius_squared);
  if (seen.doubtful > as_it_was.statistics().doubtful) {
    mark_doubtful(turns);
    running_.reset_window(); // its turns are not known
  } else {
    before_ = turns.size() > 1 ? turns[turns.size() - 2] : last_;
    last_ = turns.back();
    if (const auto found = is_stated_ ? std::nullopt : running_.add(u1, u2, sums, seen)) {
      take(*found);
    }
  }
  since_radius_ += u1.size();
  look_at_radius();
}

QuadratureDemodulator::Fault QuadratureDemodulator::fault_of(double u1, double u2) const {
  if (!std::isfinite(u1) || !std::isfinite(u2)) {
    return Fault::not_measured;
  }
  if (at_end(u1, ranges_.u1) || at_end(u2, ranges_.u2)) {
    return Fault::clipped;
  }
  if (!phase_) {
    return Fault::none;
  }
  const analysis::kernel::QuadratureCorrection c = analysis::correction_of(ellipse_);
  const double x = u1 - c.p;
  const double y = (u2 - c.q) * c.scale + x * c.tangent;
  return std::hypot(x, y) < no_beam_below * ellipse_.radius ? Fault::without_beam : Fault::none;
}

// Sample by sample: what is sound between faults is a stretch of its own.
void QuadratureDemodulator::push_faulty(std::span<const double> u1, std::span<const double> u2,
                                        std::span<double> turns) {
  std::ranges::fill(turns, not_a_number);
  for (std::size_t i = 0; i < u1.size();) {
    const std::size_t begin = i;
    while (i < u1.size() && fault_of(u1[i], u2[i]) == Fault::none) {
      ++i;
    }
    if (phase_ && i > begin) {
      const std::span<double> sound = turns.subspan(begin, i - begin);
      if (!phase_->push(u1.subspan(begin, sound.size()), u2.subspan(begin, sound.size()), sound)) {
        std::ranges::fill(sound, not_a_number); // of squares that overflow
      }
      mark_doubtful(sound);
    }
    for (; i < u1.size(); ++i) {
      const Fault fault = fault_of(u1[i], u2[i]);
      if (fault == Fault::none) {
        break;
      }
      counts_.not_measured += fault == Fault::not_measured ? 1 : 0;
      counts_.clipped += fault == Fault::clipped ? 1 : 0;
      counts_.without_beam += fault == Fault::without_beam ? 1 : 0;
      begin_again();
    }
  }
}

void QuadratureDemodulator::mark_doubtful(std::span<double> turns) {
  double before = before_;
  double last = last_;
  for (double& value : turns) {
    const double now = value;
    if (std::abs(now - 2.0 * last + before) > doubtful_turns) { // never of a NaN
      value = not_a_number;
      ++counts_.doubtful;
    }
    before = last;
    last = now;
  }
  before_ = before;
  last_ = last;
}

void QuadratureDemodulator::take(const FoundEllipse& found) {
  described_.radius_deviation_rel = analysis::deviations_with(
      found.ellipse, described_.radius_deviation_rel, std::exchange(ellipse_, found.ellipse));
  if (phase_) {
    phase_->adopt(ellipse_);
  } else {
    phase_.emplace(ellipse_);
  }
  since_radius_ = 0;
  radius_known_ = false;
  describe_ellipse(ellipse_, described_);
  described_.turns_covered = found.turns_covered;
  described_.ellipse_from = "the running signals, " + std::string(to_string(found.method));
  described_.u_ellipse_rad.assign(found.errors_rad.begin(), found.errors_rad.end());
  if (found.radius) {
    described_.periodic_error_rad = relative(*found.radius);
  }
}

void QuadratureDemodulator::look_at_radius() {
  if (radius_known_ || since_radius_ < samples_between_looks) {
    return;
  }
  since_radius_ = 0;
  if (const auto radius = phase_->radius_over_phase().harmonics()) {
    if (!periodic_error_stated_) {
      described_.periodic_error_rad = relative(*radius);
    }
    std::vector<double> deviations = phase_->radius_over_phase().deviations();
    radius_known_ = !deviations.empty(); // else some part of the turn has yet to be visited
    if (radius_known_) {
      described_.radius_deviation_rel = std::move(deviations);
    }
  }
}

} // namespace dyncal::drivers::interferometer
