#include "services/evaluation/record/step_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/evaluation/record/cut_step.hpp"
#include "services/evaluation/record/good_samples.hpp"
#include "services/evaluation/record/line_finder.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double ns_per_s = 1e9;
constexpr double distinct_frequencies_rel = 0.01; // that no window of one is one of the other
constexpr std::int64_t max_quiet_ns = 2'000'000'000;

constexpr std::int64_t beginning_of_time = std::numeric_limits<std::int64_t>::min();

std::int64_t to_ns(double seconds) {
  return static_cast<std::int64_t>(std::llround(seconds * ns_per_s));
}

} // namespace

StepSearch::StepSearch(const Recipe& recipe, const StepOrder& order, const SourceRecord& record,
                       std::string sync_channel, bool behind,
                       std::optional<RunSchedule::OfRecord> schedule, std::stop_token given_up)
    : recipe_(recipe), order_(order), record_(record), sync_channel_(std::move(sync_channel)),
      behind_(behind), schedule_(std::move(schedule)), given_up_(std::move(given_up)),
      search_from_ns_(beginning_of_time), expected_until_ns_(beginning_of_time) {}

const std::optional<ScheduledStep>* StepSearch::scheduled(std::size_t step) const {
  return schedule_ && step < schedule_->size() ? &(*schedule_)[step] : nullptr;
}

void StepSearch::search_step(std::size_t step) {
  step_ = step;
  finder_.reset();
  in_place_.reset();
  expected_.reset();
  expected_until_ns_ = beginning_of_time;
  fed_ = 0;
}

void StepSearch::advance(std::size_t last_step) {
  if (record_.restarts() != restarts_) {
    restarts_ = record_.restarts();
    search_from_ns_ = beginning_of_time;
    search_step(step_);
  }
  if (recipe_.whole_record) {
    take_whole_record(record_.ended());
    return;
  }
  while (step_ <= last_step && step_ < order_.size() && !given_up_.stop_requested()) {
    if (const auto* seen = scheduled(step_); seen != nullptr && !*seen) {
      search_step(step_ + 1);
      continue;
    }
    feed();
    if (!finder_) {
      return;
    }
    if (const auto window = finder_->window(); behind_ && window && was_passed_over(*window)) {
      search_step(step_ + 1);
    } else if (finder_->ended()) {
      accept(*window);
    } else {
      expect();
      return;
    }
  }
}

void StepSearch::take_whole_record(bool complete) {
  const auto stamps = record_.stamps_ns();
  if (complete && step_ == 0 && !stamps.empty()) {
    const auto [first, last] = std::ranges::minmax_element(stamps);
    found_[0] = {{*first, *last}};
    step_ = 1;
  }
}

void StepSearch::feed() {
  const auto channel = record_.channel(sync_channel_);
  if (!channel) {
    return;
  }
  if (!record_begin_ns_ && !record_.stamps_ns().empty()) {
    record_begin_ns_ = record_.stamps_ns().front();
  }
  if (!finder_) {
    if (const auto* seen = scheduled(step_); seen != nullptr && *seen) {
      search_from_ns_ = std::max(search_from_ns_, (*seen)->search_from_ns);
    }
    finder_.emplace(finder_of(order_.lines(step_)));
  }
  push_good_samples(
      record_, *channel,
      {static_cast<std::size_t>(std::max(fed_, record_.forgotten()) - record_.forgotten()),
       search_from_ns_},
      *finder_);
  fed_ = record_.forgotten() + record_.stamps_ns().size();
  if (record_.ended()) {
    finder_->finish();
  }
}

// A later step lies between the step before and this window.
bool StepSearch::was_passed_over(const analysis::ExcitationWindow& window) {
  if (in_place_ == window.excited_begin_ns) {
    return false;
  }
  for (std::size_t later = step_ + 1; later < order_.size() && !given_up_.stop_requested();
       ++later) {
    if (shows_before(later, window.excited_begin_ns)) {
      return true;
    }
  }
  in_place_ = window.excited_begin_ns;
  return false;
}

bool StepSearch::shows_before(std::size_t step, std::int64_t end_ns) const {
  const RecipeStep& planned = order_.step(step);
  const std::int64_t excited_ns = to_ns(planned.settling_s + planned.duration_s);
  const auto stamps = record_.stamps_ns();
  const std::int64_t begin_ns = std::max(search_from_ns_, stamps.empty() ? end_ns : stamps.front());
  const double ratio = planned.frequency.hz() / order_.step(step_).frequency.hz();
  if (std::abs(ratio - 1.0) < distinct_frequencies_rel || end_ns - begin_ns < excited_ns) {
    return false;
  }
  analysis::ExcitationWindowFinder finder(planned.frequency);
  push_good_samples(record_, *record_.channel(sync_channel_), {0, search_from_ns_, end_ns}, finder);
  finder.finish();
  const auto window = finder.window();
  return window && window->end_ns - window->begin_ns >= excited_ns / 2;
}

// Looks once a frame: in between, the window that is found so far does not change.
void StepSearch::expect() {
  const auto stamps = record_.stamps_ns();
  if (stamps.empty() || stamps.back() < expected_until_ns_) {
    return;
  }
  expected_until_ns_ = stamps.back() + finder_->frame_ns();
  expected_.reset();
  const RecipeStep& step = order_.step(step_);
  const auto window = finder_->window();
  if (window && window->end_ns >= window->begin_ns + to_ns(step.settling_s + step.duration_s)) {
    expected_ = found(*window);
  }
}

void StepSearch::accept(const analysis::ExcitationWindow& window) {
  if (const auto* seen = scheduled(step_);
      seen != nullptr && *seen &&
      (window.begin_ns >= (*seen)->excited.end_ns || window.end_ns <= (*seen)->excited.begin_ns)) {
    search_step(step_ + 1);
    return;
  }
  if (const Found one = found(window); one.interval.end_ns > one.interval.begin_ns) {
    found_[step_] = one;
  }
  search_from_ns_ = window.off_ns;
  search_step(step_ + 1);
}

// Of the step that is searched, which was excited in this window.
TimeInterval StepSearch::evaluated_part(const analysis::ExcitationWindow& window) const {
  const RecipeStep& step = order_.step(step_);
  if (const auto* seen = scheduled(step_);
      seen != nullptr && *seen && (*seen)->evaluated && !recipe_.settling_from_data) {
    return {std::max(window.begin_ns, (*seen)->evaluated->begin_ns),
            std::min(window.end_ns - 1, (*seen)->evaluated->end_ns)};
  }
  const std::int64_t planned_begin = window.begin_ns + to_ns(step.settling_s);
  return {recipe_.settling_from_data ? window.begin_ns : planned_begin,
          std::min(planned_begin + to_ns(step.duration_s), window.end_ns) - 1};
}

bool StepSearch::begins_within_step() const {
  return record_begin_ns_ && std::ranges::any_of(found_, [&](const auto& one) {
           return begins_with_record(one.second.excitation, *record_begin_ns_);
         });
}

std::optional<TimeInterval> StepSearch::quiet_time(const analysis::ExcitationWindow& window) const {
  const std::int64_t frame_ns = finder_->frame_ns();
  TimeInterval quiet{window.excited_begin_ns - frame_ns - max_quiet_ns,
                     window.excited_begin_ns - frame_ns - 1};
  if (search_from_ns_ > quiet.begin_ns - frame_ns) {
    quiet.begin_ns = search_from_ns_ + frame_ns;
  }
  return quiet.end_ns > quiet.begin_ns ? std::optional(quiet) : std::nullopt;
}

std::optional<TimeInterval> StepSearch::rise(const analysis::ExcitationWindow& window,
                                             const TimeInterval& evaluated) const {
  const std::int64_t begin_ns = window.excited_begin_ns - finder_->frame_ns();
  // A record that begins later, or anew, has only some of it. Where that of a run begins, its
  // recording does not always begin as well: the first step is the same from both without.
  const auto held = record_.stamps_ns();
  const bool is_first = search_from_ns_ == beginning_of_time && !schedule_;
  const bool shown =
      !is_first && begin_ns > search_from_ns_ && !held.empty() && held.front() <= begin_ns;
  return shown ? std::optional(TimeInterval{begin_ns, evaluated.begin_ns - 1}) : std::nullopt;
}

StepSearch::Found StepSearch::found(const analysis::ExcitationWindow& window) const {
  const TimeInterval part = evaluated_part(window);
  return {part,
          quiet_time(window),
          rise(window, part),
          {window, finder_->frame_ns()},
          search_from_ns_,
          restarts_};
}

void StepSearch::end_session() {
  if (finder_) {
    expected_until_ns_ = beginning_of_time; // what has come since the last look counts as well
    expect();
  }
  if (expected_) {
    found_[step_] = *expected_;
    search_from_ns_ = expected_->excitation.end_ns(); // it is no other step of its frequency
    search_step(step_ + 1);
  }
}

void StepSearch::give_up_step() {
  if (recipe_.whole_record) {
    take_whole_record(true);
    step_ = 1;
    return;
  }
  if (finder_) {
    finder_->finish();
    if (const auto window = finder_->window()) {
      accept(*window);
      return;
    }
  }
  search_step(step_ + 1);
}

std::optional<TimeInterval> StepSearch::interval(std::size_t step) const {
  if (const auto found = found_.find(step); found != found_.end()) {
    return found->second.interval;
  }
  return step == step_ && expected_ ? std::optional(expected_->interval) : std::nullopt;
}

const FoundExcitation* StepSearch::excitation(std::size_t step) const {
  const auto found = found_.find(step);
  return found == found_.end() ? nullptr : &found->second.excitation;
}

TimeInterval StepSearch::where_missing(std::size_t step) const {
  TimeInterval where{beginning_of_time, std::numeric_limits<std::int64_t>::max()};
  for (const auto& [other, found] : found_) {
    if (found.session != restarts_ || other == step) {
      continue;
    }
    if (other < step) {
      where.begin_ns = std::max(where.begin_ns, found.excitation.end_ns());
    } else {
      where.end_ns = std::min(where.end_ns, found.excitation.begin_ns());
    }
  }
  return where;
}

std::optional<std::uint32_t> StepSearch::session(std::size_t step) const {
  const auto found = found_.find(step);
  return found == found_.end() ? std::nullopt : std::optional(found->second.session);
}

void StepSearch::pass_over(std::size_t step) {
  const auto found = found_.find(step);
  if (found == found_.end()) {
    return;
  }
  search_from_ns_ =
      found->second.session == restarts_ ? found->second.searched_from_ns : beginning_of_time;
  found_.erase(found, found_.end());
  search_step(step + 1);
}

bool StepSearch::search_behind(std::size_t step) {
  const auto found = found_.find(step);
  if (found == found_.end() || found->second.session != restarts_) {
    return false;
  }
  search_from_ns_ = found->second.excitation.end_ns();
  found_.erase(found, found_.end());
  search_step(step);
  return true;
}

const StepSearch::Found* StepSearch::with_interval(const TimeInterval& interval) const {
  const auto found = std::ranges::find_if(
      found_, [&](const auto& one) { return one.second.interval.begin_ns == interval.begin_ns; });
  if (found != found_.end()) {
    return &found->second;
  }
  return expected_ && expected_->interval == interval ? &*expected_ : nullptr;
}

std::optional<TimeInterval> StepSearch::quiet_before(const TimeInterval& interval) const {
  const Found* found = with_interval(interval);
  return found == nullptr ? std::nullopt : found->quiet;
}

std::optional<TimeInterval> StepSearch::rise_before(const TimeInterval& interval) const {
  const Found* found = with_interval(interval);
  return found == nullptr ? std::nullopt : found->rise;
}

std::optional<std::int64_t> StepSearch::needed_for(std::size_t step) const {
  const auto found = found_.find(step);
  if (found == found_.end()) {
    return std::nullopt;
  }
  const Found& one = found->second;
  const TimeInterval& first = one.quiet ? *one.quiet : one.rise ? *one.rise : one.interval;
  return first.begin_ns;
}

} // namespace dyncal::inline evaluation
