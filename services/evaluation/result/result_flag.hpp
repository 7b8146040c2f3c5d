// What a reader of a result should know beside its numbers: a closed set of flags, each with a
// name for programs, the sentence that results carry, and what it means.
//
// The table in result_flag.cpp is the only place that names and explains them: the terminal, JSON,
// CSV, figures and `dyncal watch` take both from here. Plain data and functions; any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline evaluation {

enum class ResultFlag {
  samples_lost,
  stamps_not_trusted,  // samples with them were left out
  values_not_measured, // samples with them were left out
  shorter_than_planned,
  clock_uncertainty_unknown,
  excitation_broken_off,
  step_number_uncertain,
  level_off_plan,
  over_range,
  values_stuck,
  distorted,
  settling_not_found,
  settles_too_long,
  shots_missing,
  shots_left_out,
  records_lost, // of shots
  start_undecided,
  trigger_phase_not_corrected,
  no_monte_carlo_check,
  polarity_inverted,
  answers_before_excitation,
  adc_not_calibrated,
  reference_uncertainty_not_stated,
  mains_not_separated,
  harmonic_not_separated,
  signal_not_judged,
  peaks_bent,
  changed_within_step,
  disturbance_cut_out,
  clock_stepped,
  stamps_scatter,
  values_off_stamps,
  too_short_for_noise,
  shots_disagree,
  trigger_delay_not_stated,
  acs_delay_not_stated,
  group_delay_ambiguous,
  group_delay_not_constant,
  closure_open,
  two_writers,
  from_message // read from the bus, and not known to this version
};

// The part of the sentence that every flag of the kind has; empty for from_message.
[[nodiscard]] const char* to_string(ResultFlag flag);

// For programs: "samples_lost"; "other" for from_message.
[[nodiscard]] std::string_view name_of(ResultFlag flag);
// from_message for a name that this version does not know.
[[nodiscard]] ResultFlag parse_flag_name(std::string_view name);

// For people: what it means and what to do about it.
[[nodiscard]] std::string_view explanation_of(ResultFlag flag);

// Another attempt at the step may be without it: what came of the network, of an instrument that
// was away or of an excitation that ended early, and single samples that the device itself did not
// trust or measure (a gap in GPS reception, a clock that was set, a disturbed bus). What the set-up
// makes of a signal (range, level, distortion, clocks) comes again.
[[nodiscard]] bool may_be_cured(ResultFlag flag);

struct Flag {
  ResultFlag kind = ResultFlag::from_message;
  std::string sentence;

  friend bool operator==(const Flag&, const Flag&) = default;
};

// The kind's sentence alone; of one source or channel, "dau: samples lost"; with what only this
// case knows.
[[nodiscard]] Flag make_flag(ResultFlag kind);
[[nodiscard]] Flag flag_of_source(ResultFlag kind, const std::string& source);
[[nodiscard]] Flag flag_with_reason(ResultFlag kind, const std::string& reason);
[[nodiscard]] Flag flag_of_channel(ResultFlag kind, const std::string& channel,
                                   const std::string& reason);
[[nodiscard]] bool has_flag(const std::vector<Flag>& flags, ResultFlag kind);

[[nodiscard]] std::vector<std::string> sentences_of(const std::vector<Flag>& flags);
// One for each flag, in their order.
[[nodiscard]] std::vector<std::string> names_of(const std::vector<Flag>& flags);
// `names` may be shorter: a writer of an older contract sends none.
[[nodiscard]] std::vector<Flag> flags_from_message(const std::vector<std::string>& sentences,
                                                   const std::vector<std::string>& names);

} // namespace dyncal::inline evaluation
