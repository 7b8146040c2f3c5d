#include "services/evaluation/record/compared_excitations.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/core.h>

namespace dyncal::inline evaluation {

bool ComparedExcitations::compare() {
  if (!excitation_.is_conducted()) {
    return false;
  }
  const std::size_t lacking = lacking_.size();
  for (; compared_ < excitation_.order().size() && is_searched(compared_); ++compared_) {
    if (search_behind_earlier_attempt(compared_)) {
      return true;
    }
    compare_with_announced(compared_);
    compare_with_each_other(compared_);
  }
  return lacking_.size() > lacking;
}

bool ComparedExcitations::is_searched(std::size_t step) const {
  return std::ranges::all_of(
      searches_, [&](const ChannelSearch& search) { return search.steps.step() > step; });
}

bool ComparedExcitations::search_behind_earlier_attempt(std::size_t step) {
  if (searches_.size() != 2 || excitation_.order().attempt(step) == 1) {
    return false;
  }
  const ExcitationInBoth here = in_both(step);
  if (here.first == nullptr || here.second == nullptr) {
    return false;
  }
  const auto known = known_before(step);
  if (!known) {
    return search_behind_first_attempt(step, here);
  }
  const ExcitationInBoth there = in_both(*known);
  const ClockRate rate = clock_rate(std::array{there, here});
  const std::size_t early = lateness_s(there, here, rate) > 0.0 ? 0 : 1;
  if (instants_agree(there, here, rate) || !shows_earlier_attempt(step, early, *known)) {
    return false;
  }
  return searches_[early].steps.search_behind(step);
}

// Of sources that have shown no step together yet: by what was heard in one instant.
bool ComparedExcitations::search_behind_first_attempt(std::size_t step,
                                                      const ExcitationInBoth& here) {
  const auto offset_ns =
      sessions(step) == AnnouncedInstants::Sessions{0, 0}
          ? instants_.offset_ns({searches_[0].source, searches_[1].source}, {0, 0})
          : std::nullopt;
  if (!offset_ns || are_one_excitation(here, *offset_ns)) {
    return false;
  }
  const bool second_is_late = here.second->middle_ns() - here.first->middle_ns() > *offset_ns;
  ChannelSearch& early = searches_[second_is_late ? 0 : 1];
  const StepOrder& order = excitation_.order();
  for (std::uint32_t attempt = order.attempt(step); --attempt > 0;) {
    const auto place = order.find(order.step(step).step, attempt);
    if (place && early.steps.excitation(*place) == nullptr) {
      return early.steps.search_behind(step);
    }
  }
  return false;
}

// Of which this search has nothing, and the other one the same excitation, or nothing as well.
bool ComparedExcitations::shows_earlier_attempt(std::size_t step, std::size_t search,
                                                std::size_t known) const {
  const StepOrder& order = excitation_.order();
  const ExcitationInBoth here = in_both(step);
  for (std::uint32_t attempt = order.attempt(step); --attempt > 0;) {
    const auto place = order.find(order.step(step).step, attempt);
    if (!place || searches_[search].steps.excitation(*place) != nullptr) {
      continue;
    }
    const FoundExcitation* other = searches_[1 - search].steps.excitation(*place);
    const ExcitationInBoth pair =
        search == 0 ? ExcitationInBoth{here.first, other} : ExcitationInBoth{other, here.second};
    const ExcitationInBoth there = in_both(known);
    if (other == nullptr || instants_agree(there, pair, clock_rate(std::array{there, pair}))) {
      return true;
    }
  }
  return false;
}

// Of a source that was there from the beginning of the run, and goes on, the steps are in their
// order.
void ComparedExcitations::compare_with_announced(std::size_t step) {
  for (ChannelSearch& search : searches_) {
    // What is evaluated, not what was excited: an exciter may go on.
    const auto part = search.steps.interval(step);
    const auto over_ns = instants_.over_ns(search.source, step);
    const std::uint32_t session = search.steps.present_session();
    if (part && over_ns && search.steps.session(step) == session &&
        (may_begin_late_ || session > 0) &&
        part->begin_ns + (part->end_ns - part->begin_ns) / 2 > *over_ns) {
      pass_over(search, step, " before the step was over");
    }
  }
}

void ComparedExcitations::compare_with_each_other(std::size_t step) {
  if (searches_.size() != 2) {
    return;
  }
  const ExcitationInBoth here = in_both(step);
  if (here.first == nullptr || here.second == nullptr) {
    return;
  }
  if (const auto later = later_search(step, here)) {
    pass_over(searches_[*later], step,
              fmt::format(", when {} showed one", searches_[1 - *later].channel));
  }
}

std::optional<std::size_t> ComparedExcitations::later_search(std::size_t step,
                                                             const ExcitationInBoth& here) const {
  const auto [first_session, second_session] = sessions(step);
  const bool restarted = first_session > 0 || second_session > 0;
  if (!may_be_another(step, restarted ? excitation_.order().size() : excitation_.steps_begun())) {
    return std::nullopt;
  }
  if (const auto before = known_before(step)) {
    const ExcitationInBoth there = in_both(*before);
    const ClockRate rate = clock_rate(std::array{there, here});
    return instants_agree(there, here, rate)
               ? std::nullopt
               : std::optional<std::size_t>(lateness_s(there, here, rate) > 0.0 ? 1 : 0);
  }
  const auto offset_ns = instants_.offset_ns({searches_[0].source, searches_[1].source},
                                             {first_session, second_session});
  if (!offset_ns) { // nothing tells what the new session shows
    return restarted ? std::optional<std::size_t>(first_session > 0 ? 0 : 1) : std::nullopt;
  }
  const bool second_is_late = here.second->middle_ns() - here.first->middle_ns() > *offset_ns;
  return are_one_excitation(here, *offset_ns) ? std::nullopt
                                              : std::optional<std::size_t>(second_is_late ? 1 : 0);
}

// The last step before it that both have found in the same sessions.
std::optional<std::size_t> ComparedExcitations::known_before(std::size_t step) const {
  for (std::size_t before = step; before-- > 0;) {
    const ExcitationInBoth there = in_both(before);
    if (there.first != nullptr && there.second != nullptr && sessions(before) == sessions(step)) {
      return before;
    }
  }
  return std::nullopt;
}

// A later step of its frequency, before `end_step`.
bool ComparedExcitations::may_be_another(std::size_t step, std::size_t end_step) const {
  const StepOrder& order = excitation_.order();
  for (std::size_t later = step + 1; later < end_step; ++later) {
    if (order.step(later).frequency_text_hz == order.step(step).frequency_text_hz) {
      return true;
    }
  }
  return false;
}

// REQUIRES: two searches.
ExcitationInBoth ComparedExcitations::in_both(std::size_t step) const {
  return {searches_[0].steps.excitation(step), searches_[1].steps.excitation(step)};
}

// REQUIRES: both have found it.
AnnouncedInstants::Sessions ComparedExcitations::sessions(std::size_t step) const {
  return {*searches_[0].steps.session(step), *searches_[1].steps.session(step)};
}

void ComparedExcitations::pass_over(ChannelSearch& search, std::size_t step, std::string when) {
  search.steps.pass_over(step);
  lacking_[step].emplace(search.channel, std::move(when));
}

bool ComparedExcitations::agree_with_plan() const {
  if (excitation_.order().size() > 1 &&
      std::ranges::any_of(searches_, [](const ChannelSearch& search) {
        return search.steps.begins_within_step();
      })) {
    return false;
  }
  for (std::size_t step = 0; step < excitation_.order().size(); ++step) {
    const bool found = std::ranges::all_of(searches_, [&](const ChannelSearch& search) {
      return search.steps.excitation(step) != nullptr;
    });
    if (!found || !agree_with_step_before(step)) {
      return false;
    }
  }
  return true;
}

// With the last one of this frequency too: its phase tells most.
bool ComparedExcitations::agree_with_step_before(std::size_t step) const {
  if (searches_.size() != 2) {
    return true;
  }
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

std::string ComparedExcitations::when_missing(std::size_t step, const std::string& channel) const {
  const auto channels = lacking_.find(step);
  if (channels == lacking_.end()) {
    return "";
  }
  const auto found = channels->second.find(channel);
  return found == channels->second.end() ? "" : found->second;
}

} // namespace dyncal::inline evaluation
