#include "services/views/objections/objections.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/bench/file/check_table.hpp"
#include "services/views/language/certificate_sentences.hpp"
#include "services/views/language/closure_text.hpp"
#include "services/views/language/flag_text.hpp"
#include "services/views/language/objection_sentences.hpp"
#include "services/views/language/reason_text.hpp"
#include "services/views/language/translated_texts.hpp"
#include "services/views/objections/axis_objections.hpp"
#include "services/views/objections/refusing_flags.hpp"
#include "services/views/report/daily_check.hpp"
#include "services/views/report/result_file.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

// "80 Hz, repetition 2", with the level where the result has several.
TranslatedText place_of(const StoredResult& result, const PointIdentity& point) {
  PointIdentity mean = point;
  mean.repetition = mean.attempt = 0;
  const std::string of_mean =
      place_text(mean, {.levels = have_several_levels(result.values), .axes = false});
  return in_all_languages([&](Language language) {
    std::string text = decimal(language, of_mean);
    text += point.repetition != 0 ? sentences::of_repetition(language, point.repetition) : "";
    return text + (point.attempt > 1 ? sentences::of_attempt(language, point.attempt) : "");
  });
}

// Which values have a flag, by its name; a flag of the whole channel stands at "all frequencies".
using FlagPlaces = std::map<std::string, std::vector<TranslatedText>>;

void add_place(FlagPlaces& places, const std::vector<std::string>& flags,
               const TranslatedText& place) {
  for (const std::string& flag : flags) {
    std::vector<TranslatedText>& known = places[flag];
    if (std::ranges::find(known, place.english, &TranslatedText::english) == known.end()) {
      known.push_back(place);
    }
  }
}

FlagPlaces flag_places(const StoredResult& result, const std::string& channel) {
  FlagPlaces places;
  for (const StoredChannel& one : result.channels) {
    if (one.channel == channel) {
      add_place(places, one.flag_names, sentences::at_all_frequencies.translated());
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
                             const std::vector<TranslatedText>& places, std::string_view reason) {
  return in_all_languages([&](Language language) {
    const bool is_english = language == Language::english;
    return sentences::flag_at(language, channel, fmt::join(texts_in(language, places), ", "), flag,
                              is_english ? reason : german_meaning_of(parse_flag_name(flag)));
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
                        std::vector<TranslatedText>& objections) {
  std::vector<StoredPoint> missing;
  std::set<unsigned> measured_steps;
  for (StoredPoint& point : result.points_of(channel)) {
    if (point.valid) {
      measured_steps.insert(point.step);
    } else {
      missing.push_back(std::move(point));
    }
  }
  if (!missing.empty()) {
    const TranslatedText place = place_of(result, identity_of(missing.front()));
    const TranslatedText reason = why_without_value(missing.front());
    objections.push_back(in_all_languages([&](Language language) {
      return sentences::single_results_missing(language, channel, missing.size(),
                                               place.in(language), reason.in(language));
    }));
  }
  if (measured_steps.size() < result.planned_steps) {
    objections.push_back(in_all_languages([&](Language language) {
      return sentences::steps_missing(language, channel, measured_steps.size(),
                                      result.planned_steps);
    }));
  }
  for (const StoredValue& value : result.values_of(channel)) {
    if (!can_be_stated(value)) {
      const TranslatedText place = place_of(result, identity_of(value));
      objections.push_back(in_all_languages([&](Language language) {
        return sentences::value_without_u(language, channel, place.in(language));
      }));
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
                std::vector<TranslatedText>& objections) {
  for (const StoredPoint& point : result.points_of(channel)) {
    const bool is_explained =
        std::any_of(point.flag_names.begin(), point.flag_names.end(), explains_loss);
    if (point.valid && point.lost > 0 && !is_explained) {
      const TranslatedText place = place_of(result, identity_of(point));
      objections.push_back(in_all_languages([&](Language language) {
        return sentences::unexplained_loss(language, channel, place.in(language), point.lost);
      }));
    }
  }
}

void add_ending(const StoredResult& result, std::vector<TranslatedText>& objections) {
  if (result.interrupted) {
    objections.push_back(sentences::run_interrupted.translated());
  }
  if (!result.problem.empty()) {
    objections.push_back(in_all_languages([&](Language language) {
      return sentences::run_ended_early(language, reason_text(language, result.problem));
    }));
  }
}

} // namespace

TranslatedText why_without_value(const StoredPoint& point) {
  constexpr std::array taking{ResultFlag::over_range, ResultFlag::values_stuck,
                              ResultFlag::peaks_bent};
  std::string german;
  for (const ResultFlag flag : taking) {
    if (std::ranges::find(point.flag_names, name_of(flag)) != point.flag_names.end()) {
      german += (german.empty() ? "" : " ") + std::string(german_meaning_of(flag));
    }
  }
  return {point.problem, german.empty() ? reason_text(Language::german, point.problem) : german};
}

std::vector<TranslatedText> open_closures_of(const StoredResult& result,
                                             const std::vector<std::string>& channels) {
  std::vector<TranslatedText> open;
  for (const std::string& channel : channels) {
    for (const Closure& closure : result.closures_of(channel)) {
      if (is_open(closure)) {
        open.push_back(closure_line_text(channel, closure));
      }
    }
  }
  return open;
}

std::vector<TranslatedText> objections_to(const StoredResult& result,
                                          const std::vector<std::string>& channels) {
  std::vector<TranslatedText> objections;
  add_ending(result, objections);
  if (const auto demanded = check_settings_of(result.recipe); demanded && !result.check) {
    objections.push_back(in_all_languages([&](Language language) {
      return sentences::check_not_stated(language, demanded->sensor);
    }));
  }
  for (const TranslatedText& open : open_closures_of(result, channels)) {
    objections.push_back(in_all_languages([&](Language language) {
      return sentences::closure_is_open(language, open.in(language));
    }));
  }
  std::ranges::move(objections_to_axes(result, channels), std::back_inserter(objections));
  for (const std::string& channel : channels) {
    add_missing_values(result, channel, objections);
    add_losses(result, channel, objections);
    std::ranges::move(flags_by_verdict(result, channel, true), std::back_inserter(objections));
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
