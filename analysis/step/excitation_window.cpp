#include "analysis/step/excitation_window.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/base/phasor.hpp"
#include "analysis/base/statistics.hpp"
#include "analysis/sine/separated_lines.hpp"
#include "analysis/step/frame_sine.hpp"
#include "analysis/step/phase_line.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t min_samples = 8;     // of a frame that can be judged
constexpr double max_residual_power = 0.1; // of the power of the sine: 10 dB
constexpr double louder_than_hum = 1.3;    // in amplitude
constexpr double off_phase = 0.5;          // likewise: ten decibels of noise are 0.32
constexpr double phase_margin_rad = 0.15;
constexpr double steady_phase_margin_rad = 0.02; // of frames that the sine fills from end to end

std::int64_t floor_divide(std::int64_t value, std::int64_t divisor) {
  const std::int64_t quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

} // namespace

ExcitationWindowFinder::ExcitationWindowFinder(const Frequency& frequency,
                                               const ExcitationWindowSettings& settings,
                                               std::vector<Frequency> beside)
    : frequency_(frequency), settings_(settings), beside_(std::move(beside)),
      frame_ns_(frame_length_ns(frequency, beside_)) {}

void ExcitationWindowFinder::push(std::span<const std::int64_t> stamps_ns,
                                  std::span<const double> sync) {
  assert(stamps_ns.size() == sync.size());
  for (std::size_t i = 0; i < stamps_ns.size() && !ended_;) {
    const std::size_t run = samples_of_open_frame(stamps_ns.subspan(i), sync.subspan(i));
    if (run > 0) {
      const auto first = static_cast<std::ptrdiff_t>(i);
      const auto behind = static_cast<std::ptrdiff_t>(i + run);
      stamps_ns_.insert(stamps_ns_.end(), stamps_ns.begin() + first, stamps_ns.begin() + behind);
      values_.insert(values_.end(), sync.begin() + first, sync.begin() + behind);
      last_stamp_ns_ = stamps_ns_.back();
      i += run;
    } else {
      begin_frame_or_ignore(stamps_ns[i], sync[i]);
      ++i;
    }
  }
}

// How many of them, one after the other, belong to the frame that is open.
std::size_t ExcitationWindowFinder::samples_of_open_frame(std::span<const std::int64_t> stamps_ns,
                                                          std::span<const double> sync) const {
  if (!origin_ns_) {
    return 0;
  }
  const std::int64_t end_ns = (open_index_ + 1) * frame_ns_;
  std::int64_t last_ns = last_stamp_ns_;
  std::size_t run = 0;
  for (; run < stamps_ns.size() && stamps_ns[run] > last_ns && stamps_ns[run] < end_ns &&
         std::isfinite(sync[run]);
       ++run) {
    last_ns = stamps_ns[run];
  }
  return run;
}

// A sample that does not belong to the open frame.
void ExcitationWindowFinder::begin_frame_or_ignore(std::int64_t stamp_ns, double sync) {
  if (!std::isfinite(sync) || (origin_ns_ && stamp_ns <= last_stamp_ns_)) {
    ++ignored_samples_;
    return;
  }
  const std::int64_t index = floor_divide(stamp_ns, frame_ns_);
  if (!origin_ns_) {
    origin_ns_ = index * frame_ns_;
    first_stamp_ns_ = stamp_ns;
    open_index_ = index;
  }
  last_stamp_ns_ = stamp_ns;
  if (index != open_index_) {
    close_frame();
    open_index_ = index;
    if (ended_) {
      return;
    }
  }
  stamps_ns_.push_back(stamp_ns);
  values_.push_back(sync);
}

void ExcitationWindowFinder::finish() {
  if (ended_) {
    return;
  }
  close_frame();
  if (!ended_) {
    close_run();
    ended_ = candidate_.has_value();
  }
}

std::optional<ExcitationWindow> ExcitationWindowFinder::window() const {
  auto window = steady_part();
  if (candidate_ && (!window || window->amplitude <= louder_than_hum * candidate_->amplitude)) {
    window = candidate_;
  }
  if (window) {
    window->ended = ended_;
  }
  return window;
}

void ExcitationWindowFinder::close_frame() {
  const Frame frame = approximate();
  stamps_ns_.clear();
  values_.clear();
  if (frame.usable) {
    take(frame);
  }
}

ExcitationWindowFinder::Frame ExcitationWindowFinder::approximate() const {
  Frame frame;
  frame.index = open_index_;
  const std::size_t n = stamps_ns_.size();
  if (n < min_samples || stamps_ns_.back() - stamps_ns_.front() < frame_ns_ / 2) {
    return frame;
  }
  const std::int64_t begin_ns = open_index_ * frame_ns_;
  const auto fit = beside_.empty() ? fit_frame(frequency_, begin_ns, frame_ns_, stamps_ns_, values_)
                                   : fit_frame(frequency_, begin_ns, frame_ns_, stamps_ns_,
                                               values_without_others());
  if (!fit) {
    return frame;
  }
  frame.amplitude = fit->amplitude;
  frame.u_amplitude = fit->u_amplitude;
  frame.residual_rms = fit->residual_rms;
  frame.max_residual = fit->max_residual;
  frame.max_neighbours_rms = fit->max_neighbours_rms;
  const std::int64_t centre_ns = begin_ns + frame_ns_ / 2;
  frame.phase_rad =
      wrap_phase(fit->phase_rad - 2.0 * pi * frequency_.reduced_turns(centre_ns - *origin_ns_));
  frame.usable = true;
  return frame;
}

// As they are where the lines cannot be told apart in the frame, or do not show.
std::vector<double> ExcitationWindowFinder::values_without_others() const {
  std::vector<Frequency> lines{frequency_};
  lines.insert(lines.end(), beside_.begin(), beside_.end());
  const std::span<const double> values = values_;
  const auto separated =
      SeparatedLines::make(lines, stamps_ns_, std::span(&values, 1), LinesMayOverlap::somewhat);
  return separated ? separated->only(0, 0) : values_;
}

bool ExcitationWindowFinder::starts(const Frame& frame) const {
  const double residual_power = frame.residual_rms * frame.residual_rms;
  return frame.amplitude > 0.0 &&
         residual_power < max_residual_power * 0.5 * frame.amplitude * frame.amplitude;
}

double ExcitationWindowFinder::mean_advance_rad() const {
  constexpr std::size_t recent = 50;
  const Frame& last = run_.back();
  const Frame& first = run_[run_.size() > recent ? run_.size() - recent : 0];
  return last.index == first.index
             ? 0.0
             : (last.phase_rad - first.phase_rad) / static_cast<double>(last.index - first.index);
}

bool ExcitationWindowFinder::continues(const Frame& frame, double& unwrapped_rad) const {
  const Frame& last = run_.back();
  const double step = static_cast<double>(frame.index - last.index);
  if ((step - 1.0) * static_cast<double>(frame_ns_) * 1e-9 > settings_.max_gap_s) {
    return false;
  }
  if (static_cast<double>(frame.index - run_.front().index) * static_cast<double>(frame_ns_) *
          1e-9 >
      settings_.max_duration_s) {
    return false;
  }
  if (!starts(frame) || frame.amplitude < 0.5 * last.amplitude) {
    return false;
  }
  // An off-phase within a frame shows as neighbouring slices that the sine does not describe.
  if (frame.max_neighbours_rms > std::max(0.1 * frame.amplitude, 4.0 * last.residual_rms)) {
    return false;
  }

  const double noise =
      4.0 * std::hypot(frame.u_amplitude / frame.amplitude, last.u_amplitude / last.amplitude);
  const double max_advance = 2.0 * pi * frequency_.hz() * static_cast<double>(frame_ns_) * 1e-9 *
                             settings_.frequency_tolerance_rel;
  const bool slope_known = run_.size() >= 3;
  const double advance = slope_known ? mean_advance_rad() : 0.0;
  const double span = static_cast<double>(last.index - run_.front().index);
  const double tolerance =
      phase_margin_rad + noise +
      (slope_known ? phase_margin_rad * (step - 1.0) / std::min(span, 50.0) : max_advance * step);
  const double deviation = wrap_phase(frame.phase_rad - last.phase_rad - advance * step);
  if (tolerance >= pi || std::abs(deviation) > tolerance) {
    return false;
  }
  unwrapped_rad = last.phase_rad + advance * step + deviation;
  const double frequency_margin = max_advance + (phase_margin_rad + noise) / (span + step);
  return std::abs(unwrapped_rad - run_.front().phase_rad) <= frequency_margin * (span + step);
}

void ExcitationWindowFinder::take(const Frame& frame) {
  if (run_.empty()) {
    ended_ = candidate_ && is_quiet(frame);
    if (ended_) {
      return;
    }
    if (starts(frame)) {
      run_.push_back(frame);
    }
    return;
  }
  double unwrapped_rad = 0.0;
  if (continues(frame, unwrapped_rad)) {
    run_.push_back(frame);
    run_.back().phase_rad = unwrapped_rad;
    return;
  }
  const Frame last = run_.back();
  const bool cut_off = is_cut_off_by(frame);
  close_run();
  ended_ = candidate_ && (cut_off || is_quiet(frame));
  if (!ended_) {
    restart_run(last, frame);
  }
}

// What came before the last frame may have been the edge of this excitation.
void ExcitationWindowFinder::restart_run(const Frame& last, const Frame& frame) {
  double unwrapped_rad = 0.0;
  run_.push_back(last);
  if (continues(frame, unwrapped_rad)) {
    run_.push_back(frame);
    run_.back().phase_rad = unwrapped_rad;
    return;
  }
  run_.clear();
  if (starts(frame)) {
    run_.push_back(frame);
  }
}

// The run cannot go on with this frame, whatever it holds: it is too late.
bool ExcitationWindowFinder::is_cut_off_by(const Frame& frame) const {
  const double frame_s = static_cast<double>(frame_ns_) * 1e-9;
  return static_cast<double>(frame.index - run_.back().index - 1) * frame_s > settings_.max_gap_s ||
         static_cast<double>(frame.index - run_.front().index) * frame_s > settings_.max_duration_s;
}

// Nothing is excited in this frame as the candidate was.
bool ExcitationWindowFinder::is_quiet(const Frame& frame) const {
  return std::hypot(frame.amplitude, std::numbers::sqrt2 * frame.residual_rms) <
         off_phase * candidate_->amplitude;
}

// The run is over. If it holds a step, it may be the one that is searched.
void ExcitationWindowFinder::close_run() {
  const auto window = steady_part();
  if (window && (!candidate_ || window->amplitude > louder_than_hum * candidate_->amplitude)) {
    candidate_ = window;
  }
  run_.clear();
}

// Whether the phase over these frames of the run advances as a frequency within the tolerance does.
// Frames are taken into a run with a wide margin, for one at an edge may be filled in part only;
// but two or three of them would pass with a sine a few percent off.
bool ExcitationWindowFinder::has_nominal_frequency(std::size_t begin, std::size_t end) const {
  const Frame& first = run_[begin];
  const Frame& last = run_[end - 1];
  const double max_advance = 2.0 * pi * frequency_.hz() * static_cast<double>(frame_ns_) * 1e-9 *
                             settings_.frequency_tolerance_rel;
  // Noise is the same in both; only a frame at an edge is described worse.
  const double noise =
      4.0 * std::numbers::sqrt2 *
      std::min(first.u_amplitude / first.amplitude, last.u_amplitude / last.amplitude);
  return std::abs(last.phase_rad - first.phase_rad) <=
         max_advance * static_cast<double>(last.index - first.index) + steady_phase_margin_rad +
             noise;
}

// The longest part of the run whose amplitude stays at the plateau.
ExcitationWindowFinder::Frames ExcitationWindowFinder::longest_steady(double plateau) const {
  Frames best;
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= run_.size(); ++i) {
    const bool steady = i < run_.size() &&
                        std::abs(run_[i].amplitude - plateau) <=
                            settings_.amplitude_tolerance_rel * plateau + 4.0 * run_[i].u_amplitude;
    if (steady) {
      continue;
    }
    if (i - begin > best.size()) {
      best = {begin, i};
    }
    begin = i + 1;
  }
  return best;
}

// A frame at the edge that the sine fills only in part has residuals that its neighbours have not,
// or makes the phase advance as the sine does not.
ExcitationWindowFinder::Frames ExcitationWindowFinder::without_edges(Frames part) const {
  if (part.size() > 3) {
    std::vector<double> residuals;
    for (std::size_t i = part.begin + 1; i + 1 < part.end; ++i) {
      residuals.push_back(run_[i].max_residual);
    }
    const double usual = upper_median(residuals);
    if (run_[part.begin].max_residual > 1.6 * usual) {
      ++part.begin;
    }
    if (run_[part.end - 1].max_residual > 1.6 * usual) {
      --part.end;
    }
  }
  while (part.size() >= 2 && !has_nominal_frequency(part.begin, part.end)) {
    if (run_[part.begin].max_residual > run_[part.end - 1].max_residual) {
      ++part.begin;
    } else {
      --part.end;
    }
  }
  return part;
}

std::optional<ExcitationWindow> ExcitationWindowFinder::steady_part() const {
  if (run_.size() < 2) {
    return std::nullopt;
  }
  std::vector<double> late_amplitudes;
  for (std::size_t i = run_.size() / 2; i < run_.size(); ++i) {
    late_amplitudes.push_back(run_[i].amplitude);
  }
  const double plateau = upper_median(late_amplitudes);
  Frames part = longest_steady(plateau);
  if (part.size() < 2) {
    return std::nullopt;
  }
  part = without_edges(part);
  if (part.size() < 2) {
    return std::nullopt;
  }
  const Frame& first = run_[part.begin];
  const Frame& last = run_[part.end - 1];
  ExcitationWindow window;
  window.begin_ns = std::max(first_stamp_ns_, first.index * frame_ns_);
  window.end_ns = (last.index + 1) * frame_ns_;
  window.excited_begin_ns = std::max(first_stamp_ns_, run_.front().index * frame_ns_);
  window.off_ns = (run_.back().index + 1) * frame_ns_;
  window.amplitude = plateau;
  window.frequency_offset_rel =
      (last.phase_rad - first.phase_rad) /
      (2.0 * pi * frequency_.hz() * static_cast<double>((last.index - first.index) * frame_ns_) *
       1e-9);
  window.frames = part.size();
  describe_sine(part, window);
  if (static_cast<double>(window.end_ns - window.begin_ns) * 1e-9 < settings_.min_duration_s) {
    return std::nullopt;
  }
  return window;
}

void ExcitationWindowFinder::describe_sine(Frames part, ExcitationWindow& window) const {
  const std::int64_t first = run_[part.begin].index;
  std::vector<FramePhase> phases;
  for (std::size_t i = part.begin; i < part.end; ++i) {
    phases.push_back({static_cast<double>(run_[i].index - first), run_[i].phase_rad,
                      run_[i].u_amplitude / run_[i].amplitude});
  }
  const PhaseLine line = fit_phase_line(phases);
  const auto frame_ns = static_cast<double>(frame_ns_);
  const double turns_a_frame = frequency_.hz() * frame_ns * 1e-9;
  window.frequency_hz = frequency_.hz() * (1.0 + line.slope_rad / (2.0 * pi * turns_a_frame));
  window.u_frequency_rel = line.u_slope_rad / (2.0 * pi * turns_a_frame);
  window.middle_ns = first * frame_ns_ + std::llround((line.x_mean + 0.5) * frame_ns);
  window.phase_rad = wrap_phase(
      line.mean_rad + 2.0 * pi * frequency_.reduced_turns(window.middle_ns - *origin_ns_));
  window.u_phase_rad = line.u_mean_rad;
}

} // namespace dyncal::analysis
