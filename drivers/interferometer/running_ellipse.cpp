#include "drivers/interferometer/running_ellipse.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::interferometer {
namespace {

constexpr double window_s = 1.0;
constexpr double part_s = 0.05;
constexpr double try_every_s = 0.25;
constexpr std::uint64_t parts_between_fits = 5;
constexpr std::size_t most_parts = 20;
constexpr std::size_t most_pairs = std::size_t{1} << 21U;
constexpr std::size_t fewest_pairs = 256;
constexpr double much_better = 0.5;
constexpr double doubled_after_s = 30.0;

std::size_t pairs_in(double seconds, double rate_hz) {
  return std::max(fewest_pairs, static_cast<std::size_t>(seconds * rate_hz));
}

double size_of(const analysis::EllipseErrors& errors) {
  return std::hypot(errors[0], errors[1]);
}

void drop_first(std::vector<double>& values, std::size_t kept) {
  values.erase(values.begin(), values.end() - static_cast<std::ptrdiff_t>(kept));
}

} // namespace

RunningEllipse::RunningEllipse(double rate_hz)
    : rate_hz_(rate_hz), next_try_(pairs_in(part_s, rate_hz)) {}

void RunningEllipse::reset_window() {
  parts_.clear();
  kept_u1_.clear();
  kept_u2_.clear();
  next_try_ = pairs_in(part_s, rate_hz_);
}

std::optional<FoundEllipse> RunningEllipse::add(std::span<const double> u1,
                                                std::span<const double> u2,
                                                const analysis::EllipseMoments& sums,
                                                const analysis::PhaseStatistics& turns) {
  if (!used_) {
    return first_ellipse(u1, u2);
  }
  used_for_ += u1.size();
  const std::uint64_t before = parts_done_;
  add_to_parts(sums, turns);
  return parts_done_ != before && parts_done_ % parts_between_fits == 0 ? better_ellipse()
                                                                        : std::nullopt;
}

std::optional<FoundEllipse> RunningEllipse::first_ellipse(std::span<const double> u1,
                                                          std::span<const double> u2) {
  kept_u1_.insert(kept_u1_.end(), u1.begin(), u1.end());
  kept_u2_.insert(kept_u2_.end(), u2.begin(), u2.end());
  if (kept_u1_.size() < next_try_) {
    return std::nullopt;
  }
  const std::size_t window = std::min(pairs_in(window_s, rate_hz_), most_pairs);
  const auto found = analysis::ellipse_of_record(std::span<const double>(kept_u1_),
                                                 std::span<const double>(kept_u2_));
  if (!found) {
    problem_ = found.error().message;
    const std::size_t step = pairs_in(try_every_s, rate_hz_);
    const std::size_t kept = std::min(kept_u1_.size(), window > step ? window - step : 0);
    next_try_ = std::min(2 * kept_u1_.size(), window);
    if (kept_u1_.size() >= window) {
      drop_first(kept_u1_, kept);
      drop_first(kept_u2_, kept);
    }
    return std::nullopt;
  }
  used_ = FoundEllipse{found->fit.ellipse, analysis::ellipse_errors(found->fit), found->radius,
                       found->fit.method, found->fit.turns_covered};
  own_errors_rad_ = size_of(used_->errors_rad);
  used_for_ = 0;
  kept_u1_ = {};
  kept_u2_ = {};
  return used_;
}

void RunningEllipse::add_to_parts(const analysis::EllipseMoments& sums,
                                  const analysis::PhaseStatistics& turns) {
  const std::size_t full = pairs_in(part_s, rate_hz_);
  if (parts_.empty() || parts_.back().sums.samples() >= full) {
    parts_.push_back({{}, turns.min_turns, turns.max_turns});
  }
  Part& part = parts_.back();
  part.sums.add(sums);
  part.min_turns = std::min(part.min_turns, turns.min_turns);
  part.max_turns = std::max(part.max_turns, turns.max_turns);
  if (part.sums.samples() >= full) {
    ++parts_done_;
    while (parts_.size() > most_parts) {
      parts_.pop_front();
    }
  }
}

std::optional<FoundEllipse> RunningEllipse::better_ellipse() {
  analysis::EllipseMoments sums;
  double min_turns = parts_.front().min_turns;
  double max_turns = parts_.front().max_turns;
  for (const Part& part : parts_) {
    sums.add(part.sums);
    min_turns = std::min(min_turns, part.min_turns);
    max_turns = std::max(max_turns, part.max_turns);
  }
  const auto fit = analysis::fit_ellipse(sums, max_turns - min_turns);
  if (!fit) {
    return std::nullopt;
  }
  using analysis::EllipseMethod;
  const analysis::EllipseErrors errors = analysis::ellipse_errors(*fit);
  const double age_s = static_cast<double>(used_for_) / rate_hz_;
  const double errors_now = own_errors_rad_ * (1.0 + age_s / doubled_after_s);
  const bool first_whole_turn =
      used_->method == EllipseMethod::adjusted && fit->method == EllipseMethod::linear;
  const bool shorter =
      used_->method == EllipseMethod::linear && fit->method == EllipseMethod::adjusted;
  if (shorter || (!first_whole_turn && size_of(errors) > much_better * errors_now)) {
    return std::nullopt;
  }
  const analysis::EllipseErrors change = analysis::ellipse_difference(fit->ellipse, used_->ellipse);
  used_ = FoundEllipse{fit->ellipse,
                       {std::hypot(errors[0], change[0]), std::hypot(errors[1], change[1])},
                       std::nullopt,
                       fit->method,
                       fit->turns_covered};
  own_errors_rad_ = size_of(errors);
  used_for_ = 0;
  return used_;
}

} // namespace dyncal::drivers::interferometer
