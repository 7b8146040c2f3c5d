#include "services/views/objections/objections.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/bench/file/check_table.hpp"
#include "services/views/language/certificate_sentences.hpp"
#include "services/views/language/flag_text.hpp"
#include "services/views/objections/axis_objections.hpp"
#include "services/views/objections/refusing_flags.hpp"
#include "services/views/report/daily_check.hpp"
#include "services/views/report/result_file.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

// "80 Hz, repetition 2", with the level where the result has several.
std::string place_of(const StoredResult& result, const PointIdentity& point) {
  return place_text(point, {.levels = have_several_levels(result.values), .axes = false});
}

// Which values have a flag, by its name; a flag of the whole channel stands at "all frequencies".
using FlagPlaces = std::map<std::string, std::vector<std::string>>;

void add_place(FlagPlaces& places, const std::vector<std::string>& flags,
               const std::string& place) {
  for (const std::string& flag : flags) {
    std::vector<std::string>& known = places[flag];
    if (std::find(known.begin(), known.end(), place) == known.end()) {
      known.push_back(place);
    }
  }
}

FlagPlaces flag_places(const StoredResult& result, const std::string& channel) {
  FlagPlaces places;
  for (const StoredChannel& one : result.channels) {
    if (one.channel == channel) {
      add_place(places, one.flag_names,
                std::string(sentences::at_all_frequencies.in(Language::english)));
    }
  }
  const auto is_of_all = [&](const std::string& flag) { return places.contains(flag); };
  FlagPlaces single;
  for (const StoredValue& value : result.values_of(channel)) {
    add_place(single, value.flag_names, place_of(result, identity_of(value)));
  }
  for (const StoredPoint& point : result.points_of(channel)) {
    if (point.valid) {
      add_place(single, point.flag_names, place_of(result, mean_identity_of(point)));
    }
  }
  for (auto& [flag, where] : single) {
    if (!is_of_all(flag)) {
      places.emplace(flag, std::move(where));
    }
  }
  return places;
}

// A flag of a channel, where it is and what to think of it.
TranslatedText flag_sentence(const std::string& channel, const std::string& flag,
                             const std::vector<std::string>& places, std::string_view reason) {
  return in_all_languages([&](Language language) {
    const bool is_english = language == Language::english;
    const std::string where = decimal(language, fmt::format("{}", fmt::join(places, ", ")));
    return sentences::flag_at(language, channel,
                              where == sentences::at_all_frequencies.in(Language::english)
                                  ? sentences::at_all_frequencies(language)
                                  : where,
                              flag, is_english ? reason : german_meaning_of(parse_flag_name(flag)));
  });
}

std::vector<TranslatedText> flags_by_verdict(const StoredResult& result, const std::string& channel,
                                             bool forbidding) {
  std::vector<TranslatedText> texts;
  const bool names_closures = !result.open_closures({channel}).empty();
  for (const auto& [flag, places] : flag_places(result, channel)) {
    const ResultFlag kind = parse_flag_name(flag);
    if (kind == ResultFlag::closure_open && names_closures) {
      continue;
    }
    const FlagVerdict verdict = verdict_on(kind);
    if (verdict.forbids == forbidding) {
      texts.push_back(flag_sentence(channel, flag, places, verdict.reason));
    }
  }
  return texts;
}

void add_missing_values(const StoredResult& result, const std::string& channel,
                        std::vector<std::string>& objections) {
  std::size_t invalid = 0;
  std::string first;
  std::set<unsigned> measured_steps;
  for (const StoredPoint& point : result.points_of(channel)) {
    if (point.valid) {
      measured_steps.insert(point.step);
    } else if (++invalid == 1) {
      first = fmt::format("at {}: {}", place_of(result, identity_of(point)), point.problem);
    }
  }
  if (invalid > 0) {
    objections.push_back(
        fmt::format("{}: {} single results have no value; the first {}", channel, invalid, first));
  }
  if (measured_steps.size() < result.planned_steps) {
    objections.push_back(fmt::format("{}: {} of {} planned steps have a value", channel,
                                     measured_steps.size(), result.planned_steps));
  }
  for (const StoredValue& value : result.values_of(channel)) {
    if (!can_be_stated(value)) {
      objections.push_back(fmt::format("{} at {}: the result has no value with a usable U; it is "
                                       "left out",
                                       channel, place_of(result, identity_of(value))));
    }
  }
}

// Such flags have a verdict of their own.
bool explains_loss(const std::string& name) {
  constexpr std::array flags{ResultFlag::samples_lost, ResultFlag::records_lost,
                             ResultFlag::shots_missing, ResultFlag::shots_left_out,
                             ResultFlag::excitation_broken_off};
  return std::find(flags.begin(), flags.end(), parse_flag_name(name)) != flags.end();
}

void add_losses(const StoredResult& result, const std::string& channel,
                std::vector<std::string>& objections) {
  for (const StoredPoint& point : result.points_of(channel)) {
    const bool is_explained =
        std::any_of(point.flag_names.begin(), point.flag_names.end(), explains_loss);
    if (point.valid && point.lost > 0 && !is_explained) {
      objections.push_back(fmt::format("{} at {}: {} samples were lost within the step, and no "
                                       "flag says why",
                                       channel, place_of(result, identity_of(point)), point.lost));
    }
  }
}

} // namespace

std::vector<std::string> objections_to(const StoredResult& result,
                                       const std::vector<std::string>& channels) {
  std::vector<std::string> objections;
  if (result.interrupted) {
    objections.emplace_back("the run was interrupted");
  }
  if (!result.problem.empty()) {
    objections.push_back("the run ended early: " + result.problem);
  }
  if (const auto demanded = check_settings_of(result.recipe); demanded && !result.check) {
    objections.push_back(fmt::format("the bench demands a check with sensor '{}', and the result "
                                     "says neither when it was nor why it was left out",
                                     demanded->sensor));
  }
  for (std::string& open : result.open_closures(channels)) {
    objections.push_back("closure open: " + std::move(open));
  }
  std::ranges::move(objections_to_axes(result, channels), std::back_inserter(objections));
  for (const std::string& channel : channels) {
    add_missing_values(result, channel, objections);
    add_losses(result, channel, objections);
    for (TranslatedText& text : flags_by_verdict(result, channel, true)) {
      objections.push_back(std::move(text.english));
    }
  }
  return objections;
}

std::vector<TranslatedText> stated_flags(const StoredResult& result,
                                         const std::vector<std::string>& channels) {
  std::vector<TranslatedText> texts;
  for (const std::string& channel : channels) {
    std::ranges::move(flags_by_verdict(result, channel, false), std::back_inserter(texts));
  }
  return texts;
}

} // namespace dyncal::inline views
