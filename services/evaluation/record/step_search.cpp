#include "services/evaluation/record/step_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyncal::services {
namespace {

constexpr double ns_per_s = 1e9;
constexpr double distinct_frequencies_rel = 0.01; // that no window of one is one of the other
constexpr std::int64_t max_quiet_ns = 2'000'000'000;

constexpr std::int64_t beginning_of_time = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t end_of_time = std::numeric_limits<std::int64_t>::max();

std::int64_t to_ns(double seconds) {
  return static_cast<std::int64_t>(std::llround(seconds * ns_per_s));
}

// What to evaluate of a step that was excited in this window.
TimeInterval evaluated_part(const analysis::ExcitationWindow& window, const RecipeStep& step,
                            bool settling_from_data) {
  const std::int64_t planned_begin = window.begin_ns + to_ns(step.settling_s);
  return {settling_from_data ? window.begin_ns : planned_begin,
          std::min(planned_begin + to_ns(step.duration_s), window.end_ns) - 1};
}

} // namespace

StepSearch::StepSearch(const Recipe& recipe, const StepOrder& order, const SourceRecord& record,
                       std::string sync_channel, bool behind)
    : recipe_(recipe), order_(order), record_(record), sync_channel_(std::move(sync_channel)),
      behind_(behind), search_from_ns_(beginning_of_time), expected_until_ns_(beginning_of_time) {}

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
  while (step_ <= last_step && step_ < order_.size()) {
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
    const auto [first, last] = std::minmax_element(stamps.begin(), stamps.end());
    found_[0] = {{*first, *last}};
    step_ = 1;
  }
}

void StepSearch::feed() {
  const auto channel = record_.channel(sync_channel_);
  if (!channel) {
    return;
  }
  if (!finder_) {
    finder_.emplace(order_.step(step_).frequency);
  }
  push_good(*finder_,
            static_cast<std::size_t>(std::max(fed_, record_.forgotten()) - record_.forgotten()),
            end_of_time);
  fed_ = record_.forgotten() + record_.stamps_ns().size();
  if (record_.ended()) {
    finder_->finish();
  }
}

// The samples from where the search is to before `end_ns`, from the `from`-th that is held on.
void StepSearch::push_good(analysis::ExcitationWindowFinder& finder, std::size_t from,
                           std::int64_t end_ns) const {
  const auto stamps = record_.stamps_ns();
  const auto flags = record_.flags();
  const auto sync = record_.column(*record_.channel(sync_channel_));
  const auto good = [&](std::size_t i) {
    return flags[i] == 0 && stamps[i] >= search_from_ns_ && stamps[i] < end_ns;
  };
  for (std::size_t i = from; i < stamps.size();) {
    const std::size_t begin = i;
    while (i < stamps.size() && good(i)) {
      ++i;
    }
    finder.push(stamps.subspan(begin, i - begin), sync.subspan(begin, i - begin));
    while (i < stamps.size() && !good(i)) {
      ++i;
    }
  }
}

// A later step lies between the step before and this window.
bool StepSearch::was_passed_over(const analysis::ExcitationWindow& window) {
  if (in_place_ == window.excited_begin_ns) {
    return false;
  }
  for (std::size_t later = step_ + 1; later < order_.size(); ++later) {
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
  push_good(finder, 0, end_ns);
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
    expected_ = {evaluated_part(*window, step, recipe_.settling_from_data), quiet_time(*window)};
  }
}

void StepSearch::accept(const analysis::ExcitationWindow& window) {
  const TimeInterval part = evaluated_part(window, order_.step(step_), recipe_.settling_from_data);
  if (part.end_ns > part.begin_ns) {
    found_[step_] = {part, quiet_time(window)};
  }
  search_from_ns_ = window.off_ns;
  search_step(step_ + 1);
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

void StepSearch::end_session() {
  if (expected_) {
    found_[step_] = *expected_;
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

std::optional<TimeInterval> StepSearch::quiet_before(const TimeInterval& interval) const {
  const auto found = std::find_if(found_.begin(), found_.end(), [&](const auto& one) {
    return one.second.interval.begin_ns == interval.begin_ns;
  });
  if (found != found_.end()) {
    return found->second.quiet;
  }
  return expected_ && expected_->interval == interval ? expected_->quiet : std::nullopt;
}

std::optional<std::int64_t> StepSearch::needed_for(std::size_t step) const {
  const auto found = found_.find(step);
  if (found == found_.end()) {
    return std::nullopt;
  }
  const Found& one = found->second;
  return one.quiet ? one.quiet->begin_ns : one.interval.begin_ns;
}

} // namespace dyncal::services
