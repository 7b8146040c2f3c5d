#include "services/evaluation/record/missing_step.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/core.h>

namespace dyncal::inline evaluation {
namespace {

using Plan = std::span<const RecipeStep* const>;
using Shown = std::vector<JoinedExcitation>;

constexpr double max_untrusted_part = 0.1; // with more they are the likely cause
constexpr double min_length_part = 0.5;    // of the other record: a shorter one lacks the steps

bool shows_any(const JoinedExcitation& one) {
  return one.first || one.second;
}

// From the clock of the record that shows it to that of the other one, by the nearest step that
// both show.
std::optional<TimeInterval> in_other_clock(const std::vector<RecordedExcitations>& records,
                                           const Shown& shown, std::size_t step) {
  const bool of_first = shown[step].first.has_value();
  const auto& here = records[of_first ? 0 : 1].found;
  const auto& there = records[of_first ? 1 : 0].found;
  const FoundExcitation& one = here[of_first ? *shown[step].first : *shown[step].second];
  std::optional<std::int64_t> offset_ns;
  std::int64_t nearest_ns = 0;
  for (const JoinedExcitation& other : shown) {
    if (!other.first || !other.second) {
      continue;
    }
    const FoundExcitation& known = here[of_first ? *other.first : *other.second];
    const std::int64_t away_ns = std::abs(known.begin_ns() - one.begin_ns());
    if (!offset_ns || away_ns < nearest_ns) {
      nearest_ns = away_ns;
      offset_ns = there[of_first ? *other.second : *other.first].begin_ns() - known.begin_ns();
    }
  }
  return offset_ns
             ? std::optional(TimeInterval{one.begin_ns() + *offset_ns, one.end_ns() + *offset_ns})
             : std::nullopt;
}

// The record is about as long as the other one, its stamps are good, and it shows no step at all.
bool lacks_sync(const RecordedExcitations& lacking, const RecordedExcitations& showing) {
  return lacking.found.empty() && lacking.untrusted_part <= max_untrusted_part &&
         lacking.length_s > min_length_part * showing.length_s;
}

std::string cause(const RecordedExcitations& record, const TimeInterval& excited) {
  const std::int64_t middle_ns = excited.begin_ns + (excited.end_ns - excited.begin_ns) / 2;
  if (record.untrusted_part > max_untrusted_part) {
    return fmt::format("{:.0f} % of the time stamps of '{}' are not trusted, or lie before "
                       "others",
                       100.0 * record.untrusted_part, record.source);
  }
  if (middle_ns < record.recorded.begin_ns) {
    return fmt::format("the record of '{}' begins after it", record.source);
  }
  if (middle_ns > record.recorded.end_ns) {
    return fmt::format("the record of '{}' ends before it", record.source);
  }
  const bool in_hole = std::ranges::any_of(record.holes, [&](const TimeInterval& hole) {
    return hole.begin_ns <= middle_ns && middle_ns <= hole.end_ns;
  });
  return in_hole ? fmt::format("the record of '{}' has no samples there", record.source)
                 : fmt::format("'{}' recorded no such sine then", record.source);
}

std::string where_none_shows_it(Plan plan, const Shown& shown, std::size_t step) {
  const auto before =
      std::find_if(shown.rend() - static_cast<std::ptrdiff_t>(step), shown.rend(), shows_any);
  const auto after =
      std::find_if(shown.begin() + static_cast<std::ptrdiff_t>(step), shown.end(), shows_any);
  const auto text = [&](std::ptrdiff_t place) {
    const RecipeStep& planned = *plan[static_cast<std::size_t>(place)];
    return fmt::format("step {} ({} Hz)", planned.step, planned.frequency_text_hz);
  };
  const bool any_before = before != shown.rend();
  const bool any_after = after != shown.end();
  if (any_before && any_after) {
    return fmt::format("none was there between {} and {}", text(shown.rend() - before - 1),
                       text(after - shown.begin()));
  }
  return any_after ? fmt::format("the first that was there is {}", text(after - shown.begin()))
                   : fmt::format("the last that was there is {}", text(shown.rend() - before - 1));
}

// Steps of the same frequency and level are there: any of them may be the one that is missing.
bool may_be_another(Plan plan, const Shown& shown, std::size_t step) {
  const RecipeStep& missing = *plan[step];
  for (std::size_t other = 0; other < plan.size(); ++other) {
    const RecipeStep& one = *plan[other];
    if (other != step && shows_any(shown[other]) &&
        one.frequency_text_hz == missing.frequency_text_hz &&
        one.level_m_s2 == missing.level_m_s2) {
      return true;
    }
  }
  return false;
}

// Settling leaves nothing of it.
std::string too_short(const RecipeStep& step, const std::vector<RecordedExcitations>& records,
                      const JoinedExcitation& one) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    const FoundExcitation& found = records[i].found[i == 0 ? *one.first : *one.second];
    const double steady_s = 1e-9 * static_cast<double>(found.window.end_ns - found.window.begin_ns);
    if (steady_s <= step.settling_s) {
      return fmt::format("the sine of {} Hz in {} was steady for {:.2g} s, of which {} s are "
                         "settling; do its time stamps rise evenly?",
                         step.frequency_text_hz, records[i].channel, steady_s, step.settling_s);
    }
  }
  return "";
}

} // namespace

std::string why_missing(Plan plan, const std::vector<RecordedExcitations>& records,
                        const Shown& shown, std::size_t step) {
  const JoinedExcitation& one = shown[step];
  const bool in_all = one.first && (records.size() == 1 || one.second);
  if (in_all) {
    return too_short(*plan[step], records, one);
  }
  if (std::ranges::none_of(shown, shows_any)) {
    return "";
  }
  const std::string& frequency = plan[step]->frequency_text_hz;
  if (shows_any(one)) {
    const RecordedExcitations& lacking = records[one.first ? 1 : 0];
    const RecordedExcitations& showing = records[one.first ? 0 : 1];
    const auto excited = in_other_clock(records, shown, step);
    if (lacks_sync(lacking, showing)) {
      return fmt::format("no steady sine of {} Hz was found in {}, where {} shows one; it shows no "
                         "step at all: is the sync signal connected?",
                         frequency, lacking.channel, showing.channel);
    }
    return fmt::format("no steady sine of {} Hz was found in {}, where {} shows one: {}", frequency,
                       lacking.channel, showing.channel,
                       excited ? cause(lacking, *excited)
                               : fmt::format("'{}' shows no step that both have", lacking.source));
  }
  const std::string which =
      may_be_another(plan, shown, step)
          ? "; which of the steps of this frequency is missing, may be another than said"
          : "";
  return fmt::format("no steady sine of {} Hz was found in {}{}: {}{}", frequency,
                     records[0].channel, records.size() == 2 ? " nor in " + records[1].channel : "",
                     where_none_shows_it(plan, shown, step), which);
}

} // namespace dyncal::inline evaluation
