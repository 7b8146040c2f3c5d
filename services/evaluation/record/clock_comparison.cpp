#include "services/evaluation/record/clock_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace dyncal::inline evaluation {
namespace {

// The search knows a frequency to 1.5e-3 of the planned one, in either clock.
constexpr double same_frequency_rel = 3e-3;
// Beyond this a whole number of periods of one is none of the other.
constexpr double equal_frequency_rel = 1e-4;
constexpr double instant_margin_frames = 1.2; // a frame at an edge counts when most of it is filled
constexpr double coverage_factor = 4.0;       // one of 16 000 comparisons fails by chance
constexpr double phase_margin_rad = 0.1;      // ADC, filters: at one frequency alike in both steps
// A quarter of a turn on each side would let half of all wrong pairs pass.
constexpr double max_phase_tolerance_rad = 0.8;
constexpr double stable_clock_rel = 1e-6; // the rate of a quartz from minute to minute
constexpr double max_chance =
    0.2; // that a wrong offset fits all frequencies: then it tells nothing
constexpr double level_tolerance_rel = 0.03; // that of a steady part (excitation_window.hpp)

double seconds(std::int64_t ns) {
  return static_cast<double>(ns) * 1e-9;
}

double frame_s(const ExcitationInBoth& pair) {
  return seconds(std::max(pair.first->frame_ns, pair.second->frame_ns));
}

double max_rate_error(const ClockRate& rate) {
  return std::min(max_clock_rate_rel, coverage_factor * rate.u_rel) + stable_clock_rel;
}

// From an instant of the one pair to an instant of the other, in the second clock beyond what the
// first has.
double excess_s(std::int64_t first_ns, std::int64_t second_ns, const ClockRate& rate) {
  return seconds(second_ns - first_ns) - rate.rel * seconds(first_ns);
}

bool are_equal_frequencies(const ExcitationInBoth& one, const ExcitationInBoth& other) {
  return std::abs(one.first->window.frequency_hz / other.first->window.frequency_hz - 1.0) <
         equal_frequency_rel;
}

double instant_tolerance_s(const ExcitationInBoth& one, const ExcitationInBoth& other,
                           const ClockRate& rate) {
  const double between_s = std::abs(seconds(other.first->begin_ns() - one.first->begin_ns()));
  return instant_margin_frames * (frame_s(one) + frame_s(other)) + max_rate_error(rate) * between_s;
}

bool has_whole_begin(const ExcitationInBoth& pair) {
  return !pair.first->begin_is_cut && !pair.second->begin_is_cut;
}

bool has_whole_end(const ExcitationInBoth& pair) {
  return !pair.first->end_is_cut && !pair.second->end_is_cut;
}

} // namespace

bool have_same_frequency(const FoundExcitation& a, const FoundExcitation& b) {
  return std::abs(a.window.frequency_hz / b.window.frequency_hz - 1.0) < same_frequency_rel;
}

ClockRate clock_rate(std::span<const ExcitationInBoth> pairs) {
  double sum = 0.0, weights = 0.0;
  for (const auto& [first, second] : pairs) {
    const double u =
        std::max(1e-9, std::hypot(first->window.u_frequency_rel, second->window.u_frequency_rel));
    sum += (first->window.frequency_hz / second->window.frequency_hz - 1.0) / (u * u);
    weights += 1.0 / (u * u);
  }
  return {std::clamp(sum / weights, -2.0 * max_clock_rate_rel, 2.0 * max_clock_rate_rel),
          1.0 / std::sqrt(weights)};
}

bool instants_agree(const ExcitationInBoth& one, const ExcitationInBoth& other,
                    const ClockRate& rate) {
  const double tolerance_s = instant_tolerance_s(one, other, rate);
  const auto agree = [&](auto end_of_one, auto end_of_other) {
    const double excess =
        excess_s((other.first->*end_of_other)() - (one.first->*end_of_one)(),
                 (other.second->*end_of_other)() - (one.second->*end_of_one)(), rate);
    return std::abs(excess) <= tolerance_s;
  };
  constexpr auto begin = &FoundExcitation::begin_ns;
  constexpr auto end = &FoundExcitation::end_ns;
  return agree(begin, begin) || agree(end, end) || agree(begin, end) || agree(end, begin);
}

bool rests_agree(const ExcitationInBoth& one, const ExcitationInBoth& other, const ClockRate& rate,
                 double longest_s) {
  const bool begins = has_whole_begin(one);
  if (has_whole_begin(other) || has_whole_end(other) || (!begins && !has_whole_end(one))) {
    return false;
  }
  const auto edge = begins ? &FoundExcitation::begin_ns : &FoundExcitation::end_ns;
  const auto since_edge_s = [&](std::int64_t first_ns, std::int64_t second_ns) { // in either clock
    return std::pair((1.0 + rate.rel) * seconds(first_ns - (one.first->*edge)()),
                     seconds(second_ns - (one.second->*edge)()));
  };
  const auto [begin, begin_in_second] =
      since_edge_s(other.first->begin_ns(), other.second->begin_ns());
  const auto [end, end_in_second] = since_edge_s(other.first->end_ns(), other.second->end_ns());
  const double tolerance_s = instant_tolerance_s(one, other, rate);
  // What is not cut off there is the begin, or the end, of the whole.
  return (other.first->begin_is_cut || begin <= begin_in_second + tolerance_s) &&
         (other.second->begin_is_cut || begin_in_second <= begin + tolerance_s) &&
         (other.first->end_is_cut || end >= end_in_second - tolerance_s) &&
         (other.second->end_is_cut || end_in_second >= end - tolerance_s) &&
         std::max(end, end_in_second) - std::min(begin, begin_in_second) <= longest_s + tolerance_s;
}

double lateness_s(const ExcitationInBoth& one, const ExcitationInBoth& other,
                  const ClockRate& rate) {
  return excess_s(other.first->begin_ns() - one.first->begin_ns(),
                  other.second->begin_ns() - one.second->begin_ns(), rate);
}

std::optional<bool> phases_agree(const ExcitationInBoth& one, const ExcitationInBoth& other,
                                 const ClockRate& rate) {
  if (!are_equal_frequencies(one, other)) {
    return std::nullopt;
  }
  const double angular_hz = 2.0 * std::numbers::pi * other.second->window.frequency_hz;
  // From the last passage through zero before the middle of the one to that of the other.
  double excess_rad =
      angular_hz * excess_s(other.first->window.middle_ns - one.first->window.middle_ns,
                            other.second->window.middle_ns - one.second->window.middle_ns, rate);
  double u2_rad2 = 0.0;
  for (const auto& [excitation, sign] :
       {std::pair(one.first, -1.0), {other.first, 1.0}, {one.second, 1.0}, {other.second, -1.0}}) {
    excess_rad += sign * excitation->window.phase_rad;
    u2_rad2 += excitation->window.u_phase_rad * excitation->window.u_phase_rad;
  }
  const double between_s =
      std::abs(seconds(other.first->window.middle_ns - one.first->window.middle_ns));
  const double tolerance_rad = phase_margin_rad + coverage_factor * std::sqrt(u2_rad2) +
                               angular_hz * max_rate_error(rate) * between_s;
  if (tolerance_rad > max_phase_tolerance_rad) {
    return std::nullopt;
  }
  return std::abs(std::remainder(excess_rad, 2.0 * std::numbers::pi)) <= tolerance_rad;
}

namespace {

// One pair against the anchor, whose passage through zero is where offsets are counted from.
struct OffsetByPhase {
  double offset_s = 0.0; // to a whole number of periods
  double frequency_hz = 0.0;
  double tolerance_rad = 0.0;

  [[nodiscard]] bool fits(double anchor_s, double inversion_turns) const {
    const double turns = (anchor_s - offset_s) * frequency_hz + inversion_turns;
    return std::abs(std::remainder(turns, 1.0)) * 2.0 * std::numbers::pi <= tolerance_rad;
  }
};

// From the middle to the passage through zero before it.
double before_middle_s(const FoundExcitation& one) {
  return one.window.phase_rad / (2.0 * std::numbers::pi * one.window.frequency_hz);
}

double u_phase_rad(const ExcitationInBoth& pair) {
  return std::hypot(pair.first->window.u_phase_rad, pair.second->window.u_phase_rad);
}

OffsetByPhase offset_by_phase(const ExcitationInBoth& pair, const ExcitationInBoth& anchor,
                              const ClockRate& rate) {
  const double frequency_hz = pair.second->window.frequency_hz;
  const double angular_hz = 2.0 * std::numbers::pi * frequency_hz;
  const std::int64_t first_ns = pair.first->window.middle_ns - anchor.first->window.middle_ns;
  const std::int64_t second_ns = pair.second->window.middle_ns - anchor.second->window.middle_ns;
  const double ratio = frequency_hz / anchor.second->window.frequency_hz;
  return {excess_s(first_ns, second_ns, rate) -
              (before_middle_s(*pair.second) - before_middle_s(*anchor.second)) +
              (1.0 + rate.rel) * (before_middle_s(*pair.first) - before_middle_s(*anchor.first)),
          frequency_hz,
          phase_margin_rad +
              coverage_factor * std::hypot(u_phase_rad(pair), ratio * u_phase_rad(anchor)) +
              angular_hz * max_rate_error(rate) * std::abs(seconds(first_ns))};
}

struct OffsetRange { // of the anchor, by its begin and end
  double least_s = 0.0;
  double most_s = 0.0;
};

// By the ends that are whole in both records. REQUIRES: one is.
OffsetRange offset_range(const ExcitationInBoth& anchor, const ClockRate& rate) {
  const auto by = [&](std::int64_t first_ns, std::int64_t second_ns) {
    return excess_s(first_ns - anchor.first->window.middle_ns,
                    second_ns - anchor.second->window.middle_ns, rate) +
           before_middle_s(*anchor.second) - (1.0 + rate.rel) * before_middle_s(*anchor.first);
  };
  double begin_s = by(anchor.first->begin_ns(), anchor.second->begin_ns());
  double end_s = by(anchor.first->end_ns(), anchor.second->end_ns());
  if (!has_whole_begin(anchor)) {
    begin_s = end_s;
  } else if (!has_whole_end(anchor)) {
    end_s = begin_s;
  }
  const double margin_s = instant_margin_frames * frame_s(anchor);
  return {std::min(begin_s, end_s) - margin_s, std::max(begin_s, end_s) + margin_s};
}

} // namespace

std::optional<bool> phases_have_one_offset(std::span<const ExcitationInBoth> pairs,
                                           const ClockRate& rate) {
  const auto has_whole_edge = [](const ExcitationInBoth& pair) {
    return has_whole_begin(pair) || has_whole_end(pair);
  };
  const ExcitationInBoth& anchor = *std::max_element(
      pairs.begin(), pairs.end(), [&](const ExcitationInBoth& a, const ExcitationInBoth& b) {
        return std::pair(has_whole_edge(a), a.first->window.frequency_hz) <
               std::pair(has_whole_edge(b), b.first->window.frequency_hz);
      });
  if (!has_whole_edge(anchor)) {
    return std::nullopt;
  }
  const double half_period_s = 0.5 / anchor.second->window.frequency_hz;
  const auto [least_s, most_s] = offset_range(anchor, rate);
  const auto least = static_cast<std::int64_t>(std::ceil(least_s / half_period_s));
  const auto most = static_cast<std::int64_t>(std::floor(most_s / half_period_s));
  double chance = static_cast<double>(most - least + 1);
  std::vector<OffsetByPhase> others;
  for (const ExcitationInBoth& pair : pairs) {
    if (pair.first != anchor.first) {
      others.push_back(offset_by_phase(pair, anchor, rate));
      chance *= std::min(1.0, others.back().tolerance_rad / std::numbers::pi);
    }
  }
  if (chance > max_chance) {
    return std::nullopt;
  }
  for (std::int64_t half = least; half <= most; ++half) { // an odd one: sync is inverted
    const double inversion_turns = half % 2 == 0 ? 0.0 : 0.5;
    if (std::all_of(others.begin(), others.end(), [&](const OffsetByPhase& other) {
          return other.fits(static_cast<double>(half) * half_period_s, inversion_turns);
        })) {
      return true;
    }
  }
  return false;
}

bool are_one_excitation(const ExcitationInBoth& pair, std::int64_t offset_ns) {
  TimeInterval shorter{pair.first->begin_ns() + offset_ns, pair.first->end_ns() + offset_ns};
  TimeInterval longer{pair.second->begin_ns(), pair.second->end_ns()};
  if (shorter.end_ns - shorter.begin_ns > longer.end_ns - longer.begin_ns) {
    std::swap(shorter, longer);
  }
  const std::int64_t middle_ns = shorter.begin_ns + (shorter.end_ns - shorter.begin_ns) / 2;
  return longer.begin_ns <= middle_ns && middle_ns <= longer.end_ns;
}

std::optional<bool> levels_agree(const ExcitationInBoth& one, const ExcitationInBoth& other) {
  if (!are_equal_frequencies(one, other)) {
    return std::nullopt;
  }
  const double first = other.first->window.amplitude / one.first->window.amplitude;
  const double second = other.second->window.amplitude / one.second->window.amplitude;
  return std::abs(std::log(second / first)) <= level_tolerance_rel;
}

} // namespace dyncal::inline evaluation
