#include "services/evaluation/record/excitation_survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "analysis/base/statistics.hpp"
#include "services/contract/excitation_quantity.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/record/channel_level.hpp"
#include "services/evaluation/record/good_samples.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double cut_frames = 1.2; // a frame at an edge counts when most of it is filled
constexpr std::int64_t beginning_of_time = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kept_ns = 2'000'000'000; // of what may yet become an excitation
constexpr double kept_frames = 4.0;
constexpr std::int64_t hole_ns = 250'000'000; // the shortest step (excitation_window.hpp)
constexpr double close_frequencies_rel = 5e-3;
constexpr double hum_rel = 0.02;             // of the amplitude that the lowest level has
constexpr std::int64_t max_quiet_frames = 3; // that are no pause: edges of two parts
constexpr double longest_rel = 1.5;          // of one excitation, in parts of the longest planned
constexpr std::size_t enough_intervals = 501;

bool are_at_once(const FoundExcitation& a, const FoundExcitation& b) {
  const std::int64_t common_ns =
      std::min(a.end_ns(), b.end_ns()) - std::max(a.begin_ns(), b.begin_ns());
  return common_ns > std::min(a.end_ns() - a.begin_ns(), b.end_ns() - b.begin_ns()) / 2;
}

// Of two at once: `a` is the one that is there.
bool is_better(const FoundExcitation& a, const FoundExcitation& b) {
  if (std::abs(a.window.frequency_hz / b.window.frequency_hz - 1.0) < close_frequencies_rel) {
    return std::abs(a.window.frequency_offset_rel) <= std::abs(b.window.frequency_offset_rel);
  }
  return a.window.amplitude >= b.window.amplitude;
}

} // namespace

ExcitationSurvey::ExcitationSurvey(ChannelName searched, std::optional<std::string> reference,
                                   const std::vector<RecipeStep>& plan)
    : searched_(std::move(searched)), reference_(std::move(reference)), record_(searched_.source) {
  std::set<std::string> known;
  double lowest = std::numeric_limits<double>::infinity(), highest = 0.0;
  for (const RecipeStep& step : plan) {
    lowest = std::min(lowest, step.level_m_s2);
    highest = std::max(highest, step.level_m_s2);
    longest_step_s_ = std::max(longest_step_s_, step.settling_s + step.duration_s);
    if (known.insert(step.frequency_text_hz).second) {
      tracks_.push_back({.frequency = step.frequency, .from_ns = beginning_of_time});
    }
  }
  level_range_ = highest > 0.0 && lowest > 0.0 ? lowest / highest : 1.0;
  result_.channel = searched_.text();
  result_.source = searched_.source;
}

void ExcitationSurvey::describe(drivers::SourceDescription description) {
  record_.describe(std::move(description));
  std::set<std::size_t> columns{*record_.channel(searched_.channel)};
  if (reference_) {
    const std::size_t reference = *record_.channel(*reference_);
    columns.insert(reference);
    if (!is_acceleration(excitation_unit(record_.description(), *reference_))) {
      reference_.reset();
    }
  }
  record_.keep_only(std::move(columns));
}

void ExcitationSurvey::add(const SourceBlock& block) {
  if (record_.add(block)) {
    note_samples(block.samples);
  }
  for (Track& track : tracks_) {
    search(track);
  }
  forget();
}

void ExcitationSurvey::note_samples(std::size_t samples) {
  const auto stamps = record_.stamps_ns().last(samples);
  const auto flags = record_.flags().last(samples);
  TimeInterval& recorded = result_.recorded;
  for (std::size_t i = 0; i < samples; ++i) {
    ++samples_;
    if (flags[i] != 0) {
      ++untrusted_;
      continue;
    }
    if (samples_ - untrusted_ == 1) {
      recorded = {stamps[i], stamps[i]};
    } else if (stamps[i] <= recorded.end_ns) {
      ++untrusted_;
    } else if (stamps[i] - recorded.end_ns > hole_ns) {
      result_.holes.push_back({recorded.end_ns, stamps[i]});
    } else if (intervals_ns_.size() < enough_intervals) {
      intervals_ns_.push_back(stamps[i] - recorded.end_ns);
    }
    recorded.end_ns = std::max(recorded.end_ns, stamps[i]);
  }
}

void ExcitationSurvey::search(Track& track) {
  const std::size_t column = *record_.channel(searched_.channel);
  for (bool found = true; found;) {
    if (!track.finder) {
      track.finder.emplace(track.frequency);
      track.fed = 0;
    }
    const std::uint64_t first = std::max(track.fed, record_.forgotten()) - record_.forgotten();
    push_good_samples(record_, column, {static_cast<std::size_t>(first), track.from_ns},
                      *track.finder);
    track.fed = record_.forgotten() + record_.stamps_ns().size();
    if (record_.ended()) {
      track.finder->finish();
    }
    const auto window = track.finder->window();
    found = window && track.finder->ended() && window->off_ns > track.from_ns;
    if (found) {
      keep(track, *window);
      track.from_ns = window->off_ns;
      track.finder.reset();
    }
  }
}

void ExcitationSurvey::keep(const Track& track, const analysis::ExcitationWindow& window) {
  FoundExcitation found{.window = window, .frame_ns = track.finder->frame_ns()};
  if (reference_) {
    const auto last_ns = static_cast<std::int64_t>(1e9 * level_window_s(track.frequency.hz()));
    found.level_m_s2 = level_in(
        record_, *record_.channel(*reference_),
        {std::max(window.begin_ns, window.end_ns - last_ns), window.end_ns - 1}, track.frequency);
  }
  std::vector<FoundExcitation>& all = result_.found;
  const auto rival = std::ranges::find_if(
      all, [&](const FoundExcitation& other) { return are_at_once(found, other); });
  if (rival == all.end()) {
    all.push_back(found);
  } else if (!is_better(*rival, found)) {
    *rival = found;
  }
}

void ExcitationSurvey::forget() {
  const auto newest_ns = record_.newest_stamp_ns();
  if (!newest_ns) {
    return;
  }
  std::int64_t needed_ns = *newest_ns;
  for (const Track& track : tracks_) {
    const auto frame_ns = static_cast<double>(track.finder->frame_ns());
    needed_ns =
        std::min(needed_ns,
                 *newest_ns - std::max(kept_ns, static_cast<std::int64_t>(kept_frames * frame_ns)));
    if (const auto window = track.finder->window()) {
      needed_ns = std::min(needed_ns, window->begin_ns);
    }
  }
  record_.forget_before(needed_ns);
}

// One after the other.
bool ExcitationSurvey::are_parts_of_one(const FoundExcitation& a, const FoundExcitation& b) const {
  std::int64_t quiet_ns = b.begin_ns() - a.end_ns();
  for (const TimeInterval& hole : result_.holes) {
    quiet_ns -= std::max<std::int64_t>(0, std::min(hole.end_ns, b.begin_ns()) -
                                              std::max(hole.begin_ns, a.end_ns()));
  }
  const std::int64_t together_ns = a.end_ns() - a.begin_ns() + b.end_ns() - b.begin_ns();
  return quiet_ns < max_quiet_frames * a.frame_ns &&
         static_cast<double>(together_ns) < longest_rel * 1e9 * longest_step_s_ &&
         std::abs(a.window.frequency_hz / b.window.frequency_hz - 1.0) < close_frequencies_rel;
}

void ExcitationSurvey::join_parts(std::vector<FoundExcitation>& found) const {
  std::vector<FoundExcitation> joined;
  std::optional<FoundExcitation> last; // part of the newest one
  for (FoundExcitation& one : found) {
    if (last) {
      one.search_from_ns = last->end_ns();
    }
    const bool goes_on = last && are_parts_of_one(*last, one);
    last = one;
    if (!goes_on) {
      joined.push_back(one);
    }
  }
  found = std::move(joined);
}

void ExcitationSurvey::note_cut_ends(std::vector<FoundExcitation>& found) const {
  for (FoundExcitation& one : found) {
    const auto margin_ns =
        static_cast<std::int64_t>(cut_frames * static_cast<double>(one.frame_ns));
    one.begin_is_cut = one.begin_ns() - result_.recorded.begin_ns <= margin_ns;
    one.end_is_cut = result_.recorded.end_ns - one.end_ns() <= margin_ns;
    for (const TimeInterval& hole : result_.holes) {
      one.begin_is_cut = one.begin_is_cut || std::abs(one.begin_ns() - hole.end_ns) <= margin_ns;
      one.end_is_cut = one.end_is_cut || std::abs(hole.begin_ns - one.end_ns()) <= margin_ns;
    }
  }
}

RecordedExcitations ExcitationSurvey::result() const {
  RecordedExcitations result = result_;
  auto& found = result.found;
  std::ranges::sort(found, [](const FoundExcitation& a, const FoundExcitation& b) {
    return a.begin_ns() < b.begin_ns();
  });
  double loudest = 0.0;
  for (const FoundExcitation& one : found) {
    loudest = std::max(loudest, one.window.amplitude);
  }
  std::erase_if(found, [&](const FoundExcitation& one) {
    return one.window.amplitude < hum_rel * level_range_ * loudest;
  });
  join_parts(found);
  note_cut_ends(found);
  if (samples_ > 0 && !intervals_ns_.empty()) {
    std::vector<std::int64_t> intervals_ns = intervals_ns_;
    result.untrusted_part = static_cast<double>(untrusted_) / static_cast<double>(samples_);
    result.length_s = 1e-9 * static_cast<double>(samples_) *
                      static_cast<double>(analysis::upper_median(intervals_ns));
  }
  return result;
}

} // namespace dyncal::inline evaluation
