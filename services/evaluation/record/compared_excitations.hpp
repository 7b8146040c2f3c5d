// Whether what the searches of a conducted run have found of its steps is of these steps: held
// against what was announced, and, where two channels are searched, against each other.
//
// What a search found of a step may be of a later excitation, where the source lacks that of the
// step (it was away, its clock began anew): the step is passed over there, and its excitation left
// to the later one. And it may be of an earlier attempt, whose samples came only when that attempt
// had been given up: then it is searched once more behind that. Of two excitations that are found
// for one step, the offset of the clocks tells whether they are one: by the last step before that
// both have found, else by what was heard in one instant (announced_instants.hpp). Two that are not
// would make a value of two levels.
//
// Steps are places in the order of their excitation (step_order.hpp), each compared once, in this
// order, when every search has passed it. Belongs to one thread; what it is made of must outlive
// it.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/evaluation/record/announced_instants.hpp"
#include "services/evaluation/record/clock_comparison.hpp"
#include "services/evaluation/record/excitation_progress.hpp"
#include "services/evaluation/record/step_search.hpp"

namespace dyncal::inline evaluation {

// A channel that is searched, and the sources whose samples are selected by what it finds.
struct ChannelSearch {
  std::string source; // of the channel
  std::string channel;
  std::vector<std::string> sources;
  StepSearch steps;
};

class ComparedExcitations {
public:
  ComparedExcitations(const ExcitationProgress& excitation, const AnnouncedInstants& instants,
                      std::vector<ChannelSearch>& searches)
      : excitation_(excitation), instants_(instants), searches_(searches) {}

  // The records may lack the begin of the run, which nobody saw.
  void may_begin_late(bool may) { may_begin_late_ = may; }

  // Every search has passed the step.
  [[nodiscard]] bool is_searched(std::size_t step) const;
  // Looks at the steps that every search has passed since the last call. Returns whether to search
  // once more: some search was sent back.
  [[nodiscard]] bool compare();

  // When a channel did not show a step, where what it shows was found to be of a later one: the end
  // of a sentence, else empty.
  [[nodiscard]] std::string when_missing(std::size_t step, const std::string& channel) const;
  // Every search has found every step, all of it, and the instants of their excitations agree
  // between the searches. REQUIRES: all of the records was searched.
  [[nodiscard]] bool agree_with_plan() const;

private:
  void compare_with_announced(std::size_t step);
  void compare_with_each_other(std::size_t step);
  // Of an attempt that shows an earlier one in one search. Whether it is searched once more.
  [[nodiscard]] bool search_behind_earlier_attempt(std::size_t step);
  [[nodiscard]] bool search_behind_first_attempt(std::size_t step, const ExcitationInBoth& here);
  [[nodiscard]] bool shows_earlier_attempt(std::size_t step, std::size_t search,
                                           std::size_t known) const;
  // The search that shows a later step than the other one.
  [[nodiscard]] std::optional<std::size_t> later_search(std::size_t step,
                                                        const ExcitationInBoth& here) const;
  [[nodiscard]] std::optional<std::size_t> known_before(std::size_t step) const;
  [[nodiscard]] bool may_be_another(std::size_t step, std::size_t end_step) const;
  [[nodiscard]] bool agree_with_step_before(std::size_t step) const;
  [[nodiscard]] ExcitationInBoth in_both(std::size_t step) const;
  [[nodiscard]] AnnouncedInstants::Sessions sessions(std::size_t step) const;
  void pass_over(ChannelSearch& search, std::size_t step, std::string when);

  const ExcitationProgress& excitation_;
  const AnnouncedInstants& instants_;
  std::vector<ChannelSearch>& searches_;
  bool may_begin_late_ = false;
  std::size_t compared_ = 0; // steps before this one
  // By step and channel that shows a later one: when it shows none.
  std::map<std::size_t, std::map<std::string, std::string>> lacking_;
};

} // namespace dyncal::inline evaluation
