#include "services/evaluation/record/run_records.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/core.h>

#include "services/evaluation/record/clock_comparison.hpp"

namespace dyncal::services {

RunRecords::RunRecords(const Recipe& recipe, const std::vector<SearchedChannel>& searched,
                       std::size_t capacity, bool behind,
                       std::shared_ptr<const RunSchedule> schedule)
    : excitation_(recipe), behind_(behind), schedule_(std::move(schedule)) {
  for (const std::string& source : recipe.sources()) {
    records_.emplace(source, std::make_unique<SourceRecord>(source, capacity));
  }
  for (std::size_t i = 0; i < searched.size(); ++i) {
    const SearchedChannel& one = searched[i];
    searches_.push_back(
        {one.channel.source, one.channel.text(), one.sources,
         StepSearch(recipe, excitation_.order(), of(one.channel.source), one.channel.channel,
                    behind, schedule_ ? std::optional(schedule_->records.at(i)) : std::nullopt)});
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
  std::vector<std::string> names;
  for (const auto& [name, source] : records_) {
    if (!source->described()) {
      names.push_back(name);
    }
  }
  return names;
}

void RunRecords::announce(const StepAnnouncement& announcement) {
  excitation_.announce(announcement);
  for (const auto& [name, source] : records_) {
    for (std::size_t step = 0; step < excitation_.steps_expected(); ++step) {
      if (excitation_.is_announced_over(step)) {
        newest_when_over_ns_[name].emplace(
            step, source->newest_stamp_ns().value_or(std::numeric_limits<std::int64_t>::max()));
      }
    }
  }
}

// The clock of a source that restarts may begin anew, and that of one that has sent nothing begins
// with its first sample.
void RunRecords::follow_restarts() {
  for (auto& [name, steps] : newest_when_over_ns_) {
    const auto newest = of(name).newest_stamp_ns();
    for (auto& [step, newest_then] : steps) {
      newest_then = std::min(newest_then, newest.value_or(newest_then));
    }
  }
}

bool RunRecords::is_over_in(const std::string& source, std::size_t step) const {
  const SourceRecord& record = of(source);
  if (excitation_.is_cut_short() || record.ended()) {
    return true;
  }
  const auto steps = newest_when_over_ns_.find(source);
  const auto newest = record.newest_stamp_ns();
  if (steps == newest_when_over_ns_.end() || !newest) {
    return false;
  }
  const auto then = steps->second.find(step);
  return then != steps->second.end() && then->second <= *newest &&
         *newest - then->second > grace.count();
}

bool RunRecords::end_session(const std::string& source, std::size_t next_step) {
  bool is_needed = false;
  for (Search& search : searches_) {
    if (search.source == source) {
      search.steps.end_session();
    }
    const bool selects =
        std::find(search.sources.begin(), search.sources.end(), source) != search.sources.end();
    is_needed = is_needed || (selects && search.steps.step() > next_step);
  }
  return is_needed;
}

void RunRecords::search(std::size_t end_step) {
  follow_restarts();
  const std::size_t expected =
      std::min(behind_ ? excitation_.steps_expected() : excitation_.steps_begun(), end_step);
  if (expected == 0) {
    return;
  }
  for (bool again = true; again;) {
    search_all(expected);
    const std::size_t lacking = lacking_.size();
    compare_instants();
    again = lacking_.size() > lacking; // what was found in error is searched once more
  }
}

void RunRecords::search_all(std::size_t expected) {
  for (Search& search : searches_) {
    search.steps.advance(expected - 1);
    while (search.steps.step() < expected && is_over_in(search.source, search.steps.step())) {
      search.steps.give_up_step();
      search.steps.advance(expected - 1);
    }
  }
}

void RunRecords::compare_instants() {
  if (searches_.size() != 2 || !excitation_.is_conducted()) {
    return;
  }
  while (compared_ < excitation_.order().size() && is_searched(compared_)) {
    compare_instants(compared_++);
  }
}

// By the last step before it that both have found in the same sessions.
void RunRecords::compare_instants(std::size_t step) {
  StepSearch& first = searches_[0].steps;
  StepSearch& second = searches_[1].steps;
  const ExcitationInBoth here{first.excitation(step), second.excitation(step)};
  if (here.first == nullptr || here.second == nullptr || !may_be_another(step)) {
    return;
  }
  for (std::size_t before = step; before-- > 0;) {
    if (!first.are_of_one_session(step, before) || !second.are_of_one_session(step, before)) {
      continue;
    }
    const ExcitationInBoth there{first.excitation(before), second.excitation(before)};
    const ClockRate rate = clock_rate(std::array{there, here});
    if (!instants_agree(there, here, rate)) {
      const bool second_is_late = lateness_s(there, here, rate) > 0.0;
      (second_is_late ? second : first).pass_over(step);
      lacking_[step] = searches_[second_is_late ? 1 : 0].channel;
    }
    return;
  }
}

// A later step of its frequency that samples may show by now.
bool RunRecords::may_be_another(std::size_t step) const {
  const StepOrder& order = excitation_.order();
  for (std::size_t later = step + 1; later < excitation_.steps_begun(); ++later) {
    if (order.step(later).frequency_text_hz == order.step(step).frequency_text_hz) {
      return true;
    }
  }
  return false;
}

bool RunRecords::is_searched(std::size_t step) const {
  return std::all_of(searches_.begin(), searches_.end(),
                     [&](const Search& search) { return search.steps.step() > step; });
}

bool RunRecords::is_expected(std::size_t step) const {
  return std::all_of(searches_.begin(), searches_.end(), [&](const Search& search) {
    return search.steps.step() > step || search.steps.interval(step).has_value();
  });
}

std::optional<TimeInterval> RunRecords::interval(std::size_t search, std::size_t step) const {
  return searches_.at(search).steps.interval(step);
}

std::optional<TimeInterval> RunRecords::interval_in(const std::string& source,
                                                    std::size_t step) const {
  const auto search = std::find_if(searches_.begin(), searches_.end(), [&](const Search& one) {
    return std::find(one.sources.begin(), one.sources.end(), source) != one.sources.end();
  });
  return search == searches_.end() ? std::nullopt : search->steps.interval(step);
}

bool RunRecords::agree_with_plan() const {
  if (excitation_.order().size() > 1 &&
      std::any_of(searches_.begin(), searches_.end(),
                  [](const Search& search) { return search.steps.begins_within_step(); })) {
    return false;
  }
  for (std::size_t step = 0; step < excitation_.order().size(); ++step) {
    const bool found = std::all_of(searches_.begin(), searches_.end(), [&](const Search& search) {
      return search.steps.excitation(step) != nullptr;
    });
    if (!found || !agree_with_step_before(step)) {
      return false;
    }
  }
  return true;
}

// With the last one of this frequency too: its phase tells most.
bool RunRecords::agree_with_step_before(std::size_t step) const {
  if (searches_.size() != 2) {
    return true;
  }
  const auto in_both = [&](std::size_t at) {
    return ExcitationInBoth{searches_[0].steps.excitation(at), searches_[1].steps.excitation(at)};
  };
  const ExcitationInBoth here = in_both(step);
  for (std::size_t before = step; before-- > 0;) {
    const ExcitationInBoth there = in_both(before);
    const ClockRate rate = clock_rate(std::array{there, here});
    if (before + 1 == step && !instants_agree(there, here, rate)) {
      return false;
    }
    if (const auto level = levels_agree(there, here)) {
      return *level && phases_agree(there, here, rate).value_or(true);
    }
  }
  return true;
}

std::string RunRecords::why_missing(std::size_t step) const {
  if (const auto lacking = lacking_.find(step); lacking != lacking_.end()) {
    const std::string& channel = lacking->second;
    return fmt::format("no steady sine of {} Hz was found in {}, when {} showed one",
                       planned(step).frequency_text_hz, channel,
                       searches_[searches_[0].channel == channel ? 1 : 0].channel);
  }
  return schedule_ && step < schedule_->problems.size() ? schedule_->problems[step] : "";
}

bool RunRecords::is_uncertain(std::size_t step) const {
  return schedule_ && step < schedule_->uncertain.size() && schedule_->uncertain[step];
}

std::shared_ptr<const SourceRecord> RunRecords::part_of(const SourceRecord& whole,
                                                        const TimeInterval& interval) const {
  return copies_
             ? std::make_shared<const SourceRecord>(whole.part(interval))
             : std::shared_ptr<const SourceRecord>(std::shared_ptr<const SourceRecord>(), &whole);
}

SourceInterval RunRecords::samples(const std::string& source, const TimeInterval& interval) const {
  const SourceRecord& whole = of(source);
  SourceInterval samples{part_of(whole, interval), interval};
  for (const Search& search : searches_) {
    if (std::find(search.sources.begin(), search.sources.end(), source) == search.sources.end()) {
      continue;
    }
    if (const auto quiet = search.steps.quiet_before(interval)) {
      samples.quiet = *quiet;
      samples.quiet_record = part_of(whole, *quiet);
    }
  }
  return samples;
}

void RunRecords::forget_before_step(std::size_t next_step) {
  for (const Search& search : searches_) {
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

} // namespace dyncal::services
