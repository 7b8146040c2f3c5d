#include "services/evaluation/result/result_flag.hpp"

#include <algorithm>
#include <iterator>

namespace dyncal::services {

const char* to_string(ResultFlag flag) {
  switch (flag) {
  case ResultFlag::samples_lost:
    return "samples lost";
  case ResultFlag::stamps_not_trusted:
    return "samples left out, their stamps are not trusted";
  case ResultFlag::values_not_measured:
    return "samples left out, they were not measured";
  case ResultFlag::shorter_than_planned:
    return "shorter than planned";
  case ResultFlag::clock_uncertainty_unknown:
    return "nothing is known of the uncertainty of its clock";
  case ResultFlag::excitation_broken_off:
    return "excitation broken off";
  case ResultFlag::level_off_plan:
    return "level off plan";
  case ResultFlag::over_range:
    return "over range";
  case ResultFlag::values_stuck:
    return "values stuck";
  case ResultFlag::distorted:
    return "distorted";
  case ResultFlag::settling_not_found:
    return "settling not found";
  case ResultFlag::settles_too_long:
    return "settles for";
  case ResultFlag::shots_missing:
    return "shots";
  case ResultFlag::shots_left_out:
    return "shots of another length, rate or number of channels left out";
  case ResultFlag::records_lost:
    return "records of shots lost: not usable, or too many";
  case ResultFlag::start_undecided:
    return "start of the series";
  case ResultFlag::trigger_phase_not_corrected:
    return "the phase of the trigger is not corrected";
  case ResultFlag::no_monte_carlo_check:
    return "no Monte Carlo check";
  case ResultFlag::polarity_inverted:
    return "polarity inverted";
  case ResultFlag::answers_before_excitation:
    return "answers before its excitation: its group delay is below 0 by more than three times its "
           "uncertainty; are the channels of the roles the right ones?";
  case ResultFlag::from_message:
    break;
  }
  return "";
}

Flag make_flag(ResultFlag kind) {
  return {kind, to_string(kind)};
}

Flag flag_of_source(ResultFlag kind, const std::string& source) {
  return {kind, source + ": " + to_string(kind)};
}

Flag flag_with_reason(ResultFlag kind, const std::string& reason) {
  return {kind, to_string(kind) + (": " + reason)};
}

std::vector<std::string> sentences_of(const std::vector<Flag>& flags) {
  std::vector<std::string> sentences;
  std::transform(flags.begin(), flags.end(), std::back_inserter(sentences),
                 [](const Flag& flag) { return flag.sentence; });
  return sentences;
}

std::vector<Flag> flags_from_message(const std::vector<std::string>& sentences) {
  std::vector<Flag> flags;
  for (const std::string& sentence : sentences) {
    flags.push_back({ResultFlag::from_message, sentence});
  }
  return flags;
}

} // namespace dyncal::services
