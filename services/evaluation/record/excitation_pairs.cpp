#include "services/evaluation/record/excitation_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <tuple>

#include "services/evaluation/record/clock_comparison.hpp"

namespace dyncal::inline evaluation {
namespace {

// The search knows a frequency to 1.5e-3 (excitation_window.hpp), the fit through its phases less
// than twice as badly.
constexpr double planned_frequency_rel = 3e-3;
constexpr std::size_t decisive_ratio = 3; // of contradictions

struct Proposal {
  std::vector<JoinedExcitation> joined{};
  std::size_t pairs = 0;
  std::size_t contradictions = 0;
  std::size_t confirmations = 0;
  // The records begin and end together; one is complete, or phases confirm it: else both may be
  // cut.
  bool is_natural = false;
};

std::int64_t longest_ns(const RecordedExcitations& first, const RecordedExcitations& second) {
  std::int64_t whole_ns = 0, any_ns = 0;
  for (const auto* found : {&first.found, &second.found}) {
    for (const FoundExcitation& one : *found) {
      const std::int64_t length_ns = one.end_ns() - one.begin_ns();
      any_ns = std::max(any_ns, length_ns);
      whole_ns = std::max(whole_ns, one.begin_is_cut || one.end_is_cut ? 0 : length_ns);
    }
  }
  return whole_ns > 0 ? whole_ns : any_ns;
}

class Proposals {
public:
  Proposals(std::size_t planned, const RecordedExcitations& first,
            const RecordedExcitations& second)
      : is_one_complete_(std::max(first.found.size(), second.found.size()) >= planned),
        first_record_(first), second_record_(second), first_(first.found), second_(second.found),
        longest_ns_(longest_ns(first, second)) {}

  [[nodiscard]] std::vector<Proposal> all() const;

private:
  using Places = std::pair<std::size_t, std::size_t>;

  [[nodiscard]] ExcitationInBoth at(const Places& pair) const {
    return {&first_[pair.first], &second_[pair.second]};
  }
  [[nodiscard]] std::vector<Places> pairs_with(const Places& anchor, const ClockRate& rate) const;
  [[nodiscard]] std::vector<ExcitationInBoth> in_both(const std::vector<Places>& pairs) const;
  [[nodiscard]] Proposal proposal(const std::vector<Places>& pairs) const;
  [[nodiscard]] std::vector<JoinedExcitation> in_order(const std::vector<Places>& pairs) const;
  void compare(const std::vector<Places>& pairs, Proposal& proposal) const;
  [[nodiscard]] bool is_natural(const std::vector<Places>& pairs) const;

  [[nodiscard]] bool agree(const ExcitationInBoth& known, const Places& pair,
                           const ClockRate& rate) const {
    return instants_agree(known, at(pair), rate) ||
           rests_agree(known, at(pair), rate, 1e-9 * static_cast<double>(longest_ns_));
  }

  bool is_one_complete_; // one record shows as many as are planned
  const RecordedExcitations& first_record_;
  const RecordedExcitations& second_record_;
  const std::vector<FoundExcitation>& first_;
  const std::vector<FoundExcitation>& second_;
  std::int64_t longest_ns_; // of those that no record has cut; of all where it has cut all
};

std::vector<ExcitationInBoth> Proposals::in_both(const std::vector<Places>& pairs) const {
  std::vector<ExcitationInBoth> in_both;
  for (const Places& pair : pairs) {
    in_both.push_back(at(pair));
  }
  return in_both;
}

// In the order of their instants. An excitation has one partner at the most.
std::vector<Proposals::Places> Proposals::pairs_with(const Places& anchor,
                                                     const ClockRate& rate) const {
  std::vector<Places> pairs;
  const ExcitationInBoth known = at(anchor);
  const std::int64_t offset_ns = known.second->begin_ns() - known.first->begin_ns();
  std::size_t next = 0;
  for (std::size_t i = 0; i < first_.size() && next < second_.size(); ++i) {
    const std::int64_t reach_ns = std::max(longest_ns_, first_[i].end_ns() - first_[i].begin_ns());
    // What has ended long before cannot be a partner any more.
    while (next < second_.size() &&
           second_[next].end_ns() - offset_ns < first_[i].begin_ns() - reach_ns &&
           !agree(known, {i, next}, rate)) {
      ++next;
    }
    for (std::size_t j = next; j < second_.size(); ++j) {
      if (second_[j].begin_ns() - offset_ns > first_[i].end_ns() + reach_ns) {
        break;
      }
      if (have_same_frequency(first_[i], second_[j]) && agree(known, {i, j}, rate)) {
        pairs.emplace_back(i, j);
        next = j + 1;
        break;
      }
    }
  }
  return pairs;
}

std::vector<JoinedExcitation> Proposals::in_order(const std::vector<Places>& pairs) const {
  std::vector<JoinedExcitation> joined;
  std::size_t i = 0, j = 0;
  const std::int64_t offset_ns =
      second_[pairs.front().second].begin_ns() - first_[pairs.front().first].begin_ns();
  const auto take_alone = [&](std::size_t end_i, std::size_t end_j) {
    while (i < end_i || j < end_j) {
      if (j >= end_j || (i < end_i && first_[i].begin_ns() <= second_[j].begin_ns() - offset_ns)) {
        joined.push_back({.first = i++});
      } else {
        joined.push_back({.second = j++});
      }
    }
  };
  for (const auto& [of_first, of_second] : pairs) {
    take_alone(of_first, of_second);
    joined.push_back({i++, j++});
  }
  take_alone(first_.size(), second_.size());
  return joined;
}

// Each pair with the last one before it that has its frequency; where there is none, all together.
void Proposals::compare(const std::vector<Places>& pairs, Proposal& proposal) const {
  const ClockRate rate = clock_rate(in_both(pairs));
  for (std::size_t later = 1; later < pairs.size(); ++later) {
    const ExcitationInBoth pair = at(pairs[later]);
    for (std::size_t before = later; before-- > 0;) {
      const ExcitationInBoth other = at(pairs[before]);
      const auto same_level = levels_agree(other, pair);
      if (!same_level) {
        continue;
      }
      const auto same_phase = phases_agree(other, pair, rate);
      proposal.contradictions +=
          static_cast<std::size_t>(!*same_level || !same_phase.value_or(true));
      proposal.confirmations += static_cast<std::size_t>(*same_level && same_phase.value_or(false));
      break;
    }
  }
  if (proposal.contradictions + proposal.confirmations == 0) {
    const auto one_offset = phases_have_one_offset(in_both(pairs), rate);
    proposal.contradictions += static_cast<std::size_t>(!one_offset.value_or(true));
    proposal.confirmations += static_cast<std::size_t>(one_offset.value_or(false));
  }
}

// The records begin together and are as long: so they are where a step was not excited, a run was
// broken off, or a clock was set. The first pair tells; of a record with stamps that are far off,
// the number of samples tells how long it is.
bool Proposals::is_natural(const std::vector<Places>& pairs) const {
  const FoundExcitation& a = first_[pairs.front().first];
  const FoundExcitation& b = second_[pairs.front().second];
  const double tolerance_s = 0.5e-9 * static_cast<double>(a.end_ns() - a.begin_ns());
  const auto lead_s = [](const FoundExcitation& one, const RecordedExcitations& record) {
    return 1e-9 * static_cast<double>(one.begin_ns() - record.recorded.begin_ns);
  };
  const auto lengths_s = [](const RecordedExcitations& record) {
    return std::array{record.length_s, 1e-9 * static_cast<double>(record.recorded.end_ns -
                                                                  record.recorded.begin_ns)};
  };
  const auto lengths_agree = [&](double of_first_s) {
    const auto of_second = lengths_s(second_record_);
    return std::any_of(of_second.begin(), of_second.end(), [&](double of_second_s) {
      return of_first_s > 0.0 && std::abs(of_first_s - of_second_s) < tolerance_s;
    });
  };
  const auto of_first = lengths_s(first_record_);
  return std::abs(lead_s(a, first_record_) - lead_s(b, second_record_)) < tolerance_s &&
         std::any_of(of_first.begin(), of_first.end(), lengths_agree);
}

Proposal Proposals::proposal(const std::vector<Places>& pairs) const {
  Proposal proposal{.joined = in_order(pairs), .pairs = pairs.size()};
  compare(pairs, proposal);
  proposal.is_natural = (is_one_complete_ || proposal.confirmations > 0) && is_natural(pairs);
  return proposal;
}

std::vector<Proposal> Proposals::all() const {
  std::vector<Proposal> proposals;
  std::set<std::vector<Places>> known;
  for (std::size_t i = 0; i < first_.size(); ++i) {
    for (std::size_t j = 0; j < second_.size(); ++j) {
      if (!have_same_frequency(first_[i], second_[j])) {
        continue;
      }
      auto pairs = pairs_with({i, j}, clock_rate(in_both({{i, j}})));
      if (!pairs.empty()) {
        pairs = pairs_with({i, j}, clock_rate(in_both(pairs)));
      }
      if (!pairs.empty() && known.insert(pairs).second) {
        proposals.push_back(proposal(pairs));
      }
    }
  }
  return proposals;
}

bool fits_into(std::span<const RecipeStep* const> plan, const std::vector<JoinedExcitation>& joined,
               const RecordedExcitations& first, const RecordedExcitations& second) {
  auto step = plan.begin();
  for (const JoinedExcitation& one : joined) {
    const FoundExcitation& found = one.first ? first.found[*one.first] : second.found[*one.second];
    step = std::find_if(step, plan.end(),
                        [&](const RecipeStep* planned) { return could_be(found, *planned); });
    if (step == plan.end()) {
      return false;
    }
    ++step;
  }
  return true;
}

// One record may end before the other one begins: all that both show fits into the plan one after
// the other.
bool may_share_nothing(std::span<const RecipeStep* const> plan, const RecordedExcitations& first,
                       const RecordedExcitations& second) {
  std::vector<JoinedExcitation> of_first, of_second;
  for (std::size_t i = 0; i < first.found.size(); ++i) {
    of_first.push_back({.first = i});
  }
  for (std::size_t j = 0; j < second.found.size(); ++j) {
    of_second.push_back({.second = j});
  }
  const auto one_after_the_other = [&](std::vector<JoinedExcitation> before,
                                       const std::vector<JoinedExcitation>& after) {
    before.insert(before.end(), after.begin(), after.end());
    return fits_into(plan, before, first, second);
  };
  return one_after_the_other(of_first, of_second) || one_after_the_other(of_second, of_first);
}

struct Decision {
  std::vector<JoinedExcitation> joined;
  bool confirmed = false; // by phases, none of which contradicts
};

std::optional<Decision> decided(std::vector<Proposal> possible) {
  std::stable_sort(possible.begin(), possible.end(), [](const Proposal& a, const Proposal& b) {
    return std::tuple(a.contradictions, b.is_natural, b.confirmations) <
           std::tuple(b.contradictions, a.is_natural, a.confirmations);
  });
  const Proposal& best = possible.front();
  const bool is_decided = possible.size() == 1 ||
                          possible[1].contradictions > decisive_ratio * best.contradictions ||
                          (best.contradictions == 0 && best.is_natural);
  return is_decided ? std::optional(
                          Decision{best.joined, best.contradictions == 0 && best.confirmations > 0})
                    : std::nullopt;
}

} // namespace

bool could_be(const FoundExcitation& excitation, const RecipeStep& step) {
  return std::abs(excitation.window.frequency_hz / step.frequency.hz() - 1.0) <
         planned_frequency_rel;
}

std::optional<std::vector<JoinedExcitation>>
join_excitations(std::span<const RecipeStep* const> plan, const RecordedExcitations& first,
                 const RecordedExcitations& second) {
  const std::vector<Proposal> proposals = Proposals(plan.size(), first, second).all();
  if (proposals.empty()) {
    return std::nullopt;
  }
  std::vector<Proposal> possible;
  std::copy_if(proposals.begin(), proposals.end(), std::back_inserter(possible),
               [&](const Proposal& one) { return fits_into(plan, one.joined, first, second); });
  if (possible.empty()) {
    const auto most =
        std::max_element(proposals.begin(), proposals.end(),
                         [](const Proposal& a, const Proposal& b) { return a.pairs < b.pairs; });
    std::copy_if(proposals.begin(), proposals.end(), std::back_inserter(possible),
                 [&](const Proposal& one) { return one.pairs + 1 >= most->pairs; });
  }
  auto best = decided(std::move(possible));
  return best && (best->confirmed || !may_share_nothing(plan, first, second))
             ? std::optional(std::move(best->joined))
             : std::nullopt;
}

} // namespace dyncal::inline evaluation
