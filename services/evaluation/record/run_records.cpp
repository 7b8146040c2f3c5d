#include "services/evaluation/record/run_records.hpp"

#include <algorithm>
#include <limits>

namespace dyncal::inline evaluation {

RunRecords::RunRecords(const Recipe& recipe, const std::vector<SearchedChannel>& searched,
                       std::size_t capacity, bool behind,
                       std::shared_ptr<const RunSchedule> schedule, std::stop_token given_up)
    : excitation_(recipe), behind_(behind), schedule_(std::move(schedule)),
      given_up_(std::move(given_up)), compared_(excitation_, instants_, searches_) {
  for (const std::string& source : recipe.sources()) {
    records_.emplace(source, std::make_unique<SourceRecord>(source, capacity));
  }
  for (std::size_t i = 0; i < searched.size(); ++i) {
    const SearchedChannel& one = searched[i];
    searches_.push_back(
        {one.channel.source, one.channel.text(), one.sources,
         StepSearch(recipe, excitation_.order(), of(one.channel.source), one.channel.channel,
                    behind, schedule_ ? std::optional(schedule_->records.at(i)) : std::nullopt,
                    given_up_)});
  }
}

std::vector<std::string> RunRecords::sources() const {
  std::vector<std::string> names;
  for (const auto& [name, source] : records_) {
    names.push_back(name);
  }
  return names;
}

SourceRecord* RunRecords::find(const std::string& source) {
  const auto found = records_.find(source);
  return found == records_.end() ? nullptr : found->second.get();
}

const SourceRecord& RunRecords::of(const std::string& source) const {
  return *records_.at(source);
}

std::vector<std::string> RunRecords::undescribed() const {
  std::vector<std::string> names = sources();
  std::erase_if(names, [&](const std::string& name) { return of(name).described(); });
  return names;
}

void RunRecords::announce(const StepAnnouncement& announcement,
                          std::optional<std::int64_t> heard_ns) {
  excitation_.announce(announcement);
  if (heard_ns) {
    instants_.hear(*heard_ns);
  }
  for (std::size_t step = 0; step < excitation_.steps_expected(); ++step) {
    if (heard_ns && excitation_.is_announced_over(step)) {
      instants_.add_over(step, *heard_ns);
    }
  }
  note_newest_stamps();
}

void RunRecords::note_newest_stamps() {
  for (const auto& [name, source] : records_) {
    const std::int64_t newest_ns =
        source->newest_stamp_ns().value_or(std::numeric_limits<std::int64_t>::max());
    for (std::size_t step = 0; step < excitation_.steps_expected(); ++step) {
      if (excitation_.is_announced_over(step)) {
        instants_.add_over(name, step, newest_ns);
      }
    }
  }
  if (searches_.size() == 2) {
    const SourceRecord& first = of(searches_[0].source);
    const SourceRecord& second = of(searches_[1].source);
    if (first.newest_stamp_ns() && second.newest_stamp_ns()) {
      instants_.add_offset({first.restarts(), second.restarts()},
                           *second.newest_stamp_ns() - *first.newest_stamp_ns());
    }
  }
}

void RunRecords::follow_restarts() {
  for (const auto& [name, source] : records_) {
    const auto newest_ns = source->newest_stamp_ns();
    const auto followed = followed_.find(name);
    if (newest_ns && (followed == followed_.end() || followed->second != source->restarts())) {
      instants_.follow(name, *newest_ns);
      followed_[name] = source->restarts();
    }
  }
}

bool RunRecords::is_over_in(const std::string& source, std::size_t step) const {
  const SourceRecord& record = of(source);
  if (excitation_.is_cut_short() || record.ended()) {
    return true;
  }
  const auto newest_ns = record.newest_stamp_ns();
  const auto over_ns = instants_.over_ns(source, step);
  const auto had_come_ns = instants_.newest_when_over_ns(source, step);
  if (!newest_ns || !over_ns || !had_come_ns || *had_come_ns > *newest_ns) {
    return false;
  }
  const std::int64_t then_ns = std::min(*over_ns, *had_come_ns + longest_delay.count());
  return *newest_ns - then_ns > grace.count() && instants_.has_gone_on(source, step, grace);
}

// That samples may show by now.
std::size_t RunRecords::steps_searched() const {
  return behind_ ? excitation_.steps_expected() : excitation_.steps_begun();
}

bool RunRecords::end_session(const std::string& source, std::size_t next_step) {
  bool is_needed = false;
  const std::size_t expected = steps_searched();
  for (ChannelSearch& search : searches_) {
    if (search.source == source && expected > 0) {
      search_one(search, expected);
      search.steps.end_session();
    }
    const bool selects = std::ranges::find(search.sources, source) != search.sources.end();
    is_needed = is_needed || (selects && search.steps.step() > next_step);
  }
  return is_needed;
}

void RunRecords::search(std::size_t end_step) {
  follow_restarts();
  // Whether anything was excited at all, other channels tell once all of them have come.
  const bool waits = schedule_ && !schedule_->shows_any_step() && !excitation_.is_cut_short() &&
                     !std::ranges::all_of(records_, [](auto& one) { return one.second->ended(); });
  const std::size_t expected = waits ? 0 : std::min(steps_searched(), end_step);
  if (expected == 0) {
    return;
  }
  for (bool again = true; again;) {
    search_all(expected);
    again = compared_.compare(); // what was found in error is searched once more
  }
}

void RunRecords::search_all(std::size_t expected) {
  for (ChannelSearch& search : searches_) {
    search_one(search, expected);
  }
}

void RunRecords::search_one(ChannelSearch& search, std::size_t expected) const {
  search.steps.advance(expected - 1);
  while (search.steps.step() < expected && !given_up_.stop_requested() &&
         is_over_in(search.source, search.steps.step())) {
    search.steps.give_up_step();
    search.steps.advance(expected - 1);
  }
}

bool RunRecords::is_expected(std::size_t step) const {
  return std::ranges::all_of(searches_, [&](const ChannelSearch& search) {
    return search.steps.step() > step || search.steps.interval(step).has_value();
  });
}

std::optional<TimeInterval> RunRecords::interval(std::size_t search, std::size_t step) const {
  return searches_.at(search).steps.interval(step);
}

std::vector<ChannelSearch>::const_iterator RunRecords::search_of(const std::string& source) const {
  return std::ranges::find_if(searches_, [&](const ChannelSearch& one) {
    return std::ranges::find(one.sources, source) != one.sources.end();
  });
}

std::optional<TimeInterval> RunRecords::interval_in(const std::string& source,
                                                    std::size_t step) const {
  const auto search = search_of(source);
  return search == searches_.end() ? std::nullopt : search->steps.interval(step);
}

std::string RunRecords::why_missing(std::size_t step) const {
  return schedule_ && step < schedule_->problems.size() ? schedule_->problems[step] : "";
}

TimeInterval RunRecords::where_missing(const std::string& source, std::size_t step) const {
  using Limits = std::numeric_limits<std::int64_t>;
  const auto search = search_of(source);
  return search == searches_.end() ? TimeInterval{Limits::min(), Limits::max()}
                                   : search->steps.where_missing(step);
}

bool RunRecords::began_after(const std::string& source, std::size_t step) const {
  const auto over_ns = instants_.over_ns(source, step);
  const auto began_ns = of(source).began_ns();
  return over_ns && began_ns && *over_ns < *began_ns;
}

bool RunRecords::ended_before(const std::string& source, std::size_t step) const {
  const auto over_ns = instants_.over_ns(source, step);
  const auto newest_ns = of(source).newest_stamp_ns();
  return over_ns && newest_ns && *newest_ns < *over_ns;
}

bool RunRecords::is_uncertain(std::size_t step) const {
  return schedule_ && step < schedule_->uncertain.size() && schedule_->uncertain[step];
}

std::shared_ptr<const SourceRecord> RunRecords::part_of(const SourceRecord& whole,
                                                        const TimeInterval& interval) const {
  using Part = std::shared_ptr<const SourceRecord>;
  return copies_ ? std::make_shared<const SourceRecord>(whole.part(interval))
                 : Part(Part(), &whole);
}

SourceInterval RunRecords::samples(const std::string& source, const TimeInterval& interval) const {
  const SourceRecord& whole = of(source);
  SourceInterval samples{part_of(whole, interval), interval};
  if (const auto search = search_of(source); search != searches_.end()) {
    if (const auto quiet = search->steps.quiet_before(interval)) {
      samples.quiet = *quiet;
      samples.quiet_record = part_of(whole, *quiet);
    }
    if (const auto rise = search->steps.rise_before(interval)) {
      samples.rise = *rise;
      samples.rise_record = part_of(whole, *rise);
    }
  }
  return samples;
}

void RunRecords::forget_before_step(std::size_t next_step) {
  for (const ChannelSearch& search : searches_) {
    std::int64_t needed = search.steps.needed_from_ns();
    for (std::size_t step = next_step; step < search.steps.step(); ++step) {
      if (const auto from_ns = search.steps.needed_for(step)) {
        needed = std::min(needed, *from_ns);
      }
    }
    for (const std::string& source : search.sources) {
      records_.at(source)->forget_before(needed);
    }
  }
}

} // namespace dyncal::inline evaluation
