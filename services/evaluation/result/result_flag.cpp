#include "services/evaluation/result/result_flag.hpp"

#include <algorithm>
#include <array>
#include <iterator>

namespace dyncal::inline evaluation {
namespace {

struct Row {
  ResultFlag kind;
  const char* name;
  const char* sentence;
  const char* explanation;
  bool may_be_cured = false;
};

// In the order of the enum.
constexpr std::array rows{
    Row{ResultFlag::samples_lost, "samples_lost", "samples lost",
        "samples of this source are missing within the step and the fit uses the others; check "
        "its network, its buffers and the load of its computer",
        true},
    Row{ResultFlag::stamps_not_trusted, "stamps_not_trusted",
        "samples left out, their stamps are not trusted",
        "the device or the check of its stamps does not trust some of them, and their samples are "
        "left out; check the clock and the GPS reception of the unit",
        true},
    Row{ResultFlag::values_not_measured, "values_not_measured",
        "samples left out, they were not measured",
        "the device sent samples without a value, which are left out; check its settings", true},
    Row{ResultFlag::shorter_than_planned, "shorter_than_planned", "shorter than planned",
        "less of the steady sine was recorded than the plan asks for, so the noise in u is larger "
        "than planned; repeat the step, or lengthen what the generator plays",
        true},
    Row{ResultFlag::clock_uncertainty_unknown, "clock_uncertainty_unknown",
        "nothing is known of the uncertainty of its clock",
        "u of the phase holds nothing for the time stamps of this source; find their uncertainty "
        "and state it as u_stamp_s of a file, or add it by hand"},
    Row{ResultFlag::excitation_broken_off, "excitation_broken_off", "excitation broken off",
        "the step ended before its time, and what was recorded until then was evaluated; repeat "
        "the step",
        true},
    Row{ResultFlag::step_number_uncertain, "step_number_uncertain",
        "it may be another step of this frequency and level",
        "steps of the same frequency and level were planned, the records do not show all of them, "
        "and nothing tells which these are; the value holds for its frequency and level, its "
        "number may be another one; begin the records before the first step"},
    Row{ResultFlag::level_off_plan, "level_off_plan", "level off plan",
        "the reference shows another level than planned, and the value holds for what it shows; "
        "check level_per_volt and the amplifier, or set level_tolerance_rel"},
    Row{ResultFlag::over_range, "over_range", "over range",
        "samples lie at an end of the channel's range, where the sine is cut off; lower the level "
        "or choose a wider range"},
    Row{ResultFlag::values_stuck, "values_stuck", "values stuck",
        "the channel repeats one value while the signal moves; check the sensor and its interface"},
    Row{ResultFlag::distorted, "distorted", "distorted",
        "the channel shows more harmonics than ISO 16063-21 allows an excitation; check exciter, "
        "mounting and level"},
    Row{ResultFlag::settling_not_found, "settling_not_found", "settling not found",
        "the data do not show when the sine became steady, so the planned settling time was left "
        "out; look at the record, or state settling_s"},
    Row{ResultFlag::settles_too_long, "settles_too_long", "settles for",
        "the sine was not yet steady when the evaluation began; raise settling_s"},
    Row{ResultFlag::shots_missing, "shots_missing", "shots",
        "fewer shots than planned came or could be used, so u is larger than planned; check the "
        "trigger and repeat the step",
        true},
    Row{ResultFlag::shots_left_out, "shots_left_out",
        "shots of another length, rate or number of channels left out",
        "the settings of an instrument changed during the step; repeat it with unchanged settings",
        true},
    Row{ResultFlag::records_lost, "records_lost", "records of shots lost: not usable, or too many",
        "records of this source could not be used or exceeded what is held; check the instrument "
        "and the number of shots",
        true},
    Row{ResultFlag::start_undecided, "start_undecided", "start of the series",
        "the phases of the shots do not show how the series starts after the trigger, which u "
        "allows for; record more shots"},
    Row{ResultFlag::trigger_phase_not_corrected, "trigger_phase_not_corrected",
        "the phase of the trigger is not corrected",
        "noise and threshold of the trigger are left in the phase; set trigger_phase_correction "
        "= true for a calibration"},
    Row{ResultFlag::no_monte_carlo_check, "no_monte_carlo_check", "no Monte Carlo check",
        "the cross-check that the bench file asks for was not possible for the reason given; the "
        "value and its u stand without it"},
    Row{ResultFlag::polarity_inverted, "polarity_inverted", "polarity inverted",
        "the phase tends to pi at 0 Hz, or repetitions point in opposite directions: sensor or "
        "reference point the other way or a cable is reversed; turn it, or add pi to the phase "
        "when comparing"},
    Row{ResultFlag::answers_before_excitation, "answers_before_excitation",
        "answers before its excitation",
        "the group delay is below 0 by more than three times its uncertainty, which no sensor "
        "does; check which channels the roles name, and the corrections"},
    Row{ResultFlag::adc_not_calibrated, "adc_not_calibrated", "sync ADC not calibrated",
        "u of the phase holds without the delay of the ADC that records sync; name its calibration "
        "as corrections.adc, or state uncertainty.adc_delay_s"},
    Row{ResultFlag::reference_uncertainty_not_stated, "reference_uncertainty_not_stated",
        "the uncertainty of the reference is not stated",
        "u holds without it; name the calibration of the reference as corrections.reference, or "
        "state uncertainty.reference_magnitude_rel and .reference_phase_rad"},
    Row{ResultFlag::mains_not_separated, "mains_not_separated",
        "cannot be told from the excitation",
        "u holds nothing for hum here: the channel never showed it apart from an excitation in "
        "this run; add a step at another frequency, or take a frequency farther from the mains"},
    Row{ResultFlag::harmonic_not_separated, "harmonic_not_separated",
        "falls on the excitation at this sample rate",
        "u holds nothing for distortion folded there: no step of this run shows that harmonic by "
        "itself; choose another frequency or sample rate, or add a step at a lower frequency"},
    Row{ResultFlag::signal_not_judged, "signal_not_judged", "signal not judged",
        "end stops, stuck values and distortion could not be looked for in this channel for the "
        "reason given, so look at its record; the value and its u stand without that check"},
    Row{ResultFlag::peaks_bent, "peaks_bent", "its peaks are bent",
        "the tops of the sine are flatter or sharper than those of the reference, at one end "
        "or both, as at an end stop before a filter; lower the level, or choose a wider range"},
    Row{ResultFlag::changed_within_step, "changed_within_step", "changed within the step",
        "sensitivity or delay of the channel changed while the step was recorded, or samples "
        "were dropped or repeated without a trace; look at the record, then at filters, "
        "buffers and clock",
        true},
    Row{ResultFlag::disturbance_cut_out, "disturbance_cut_out", "a disturbance was cut out",
        "for a short time the channel showed something far beside the sine, and these samples "
        "are left out; find the knock, or repeat the step",
        true},
    Row{ResultFlag::clock_stepped, "clock_stepped", "its clock stepped within the step",
        "the stamps of this source jump within the step and the value mixes two time scales; "
        "check its synchronisation, and repeat the step",
        true},
    Row{ResultFlag::stamps_scatter, "stamps_scatter", "its stamps scatter",
        "stamps are off by so much that the sine is visibly shortened, which was corrected "
        "with what their intervals show, and u allows for it; take the stamps closer to the "
        "sensor"},
    Row{ResultFlag::values_off_stamps, "values_off_stamps",
        "values are not of the instants of their stamps",
        "values are held, exchanged, interleaved, polled or read in batches, so that the "
        "stamps do not say when they were measured; check how the sensor is read"},
    Row{ResultFlag::too_short_for_noise, "too_short_for_noise", "too short to know its noise",
        "the noise is slow beside the few periods of the record, so that the record cannot "
        "show how large it is; record more periods, or repeat the step"},
    Row{ResultFlag::shots_disagree, "shots_disagree", "shots disagree",
        "shots differ by more than their noise, or a series changes within itself, as when "
        "samples are lost or the sensor's clock wanders; check the sensor's sampling, and "
        "record the step again",
        true},
    Row{ResultFlag::trigger_delay_not_stated, "trigger_delay_not_stated",
        "the delay of the oscilloscope's trigger is not stated",
        "phase and its u hold without it; measure it with dyncal calibrate dso-delay, and name "
        "it as corrections.dso_delay"},
    Row{ResultFlag::acs_delay_not_stated, "acs_delay_not_stated",
        "the delay between the channels of the ACS is not stated",
        "u of the phase holds without it; state uncertainty.acs_delay_s, or "
        "corrections.reference_delay with its uncertainty"},
    Row{ResultFlag::group_delay_ambiguous, "group_delay_ambiguous", "the group delay is ambiguous",
        "the frequencies are too far apart to tell it from others that differ by a whole "
        "number of periods; add a step close to another one"},
    Row{ResultFlag::group_delay_not_constant, "group_delay_not_constant",
        "the group delay is not constant",
        "the phases do not lie on one line over frequency, so that no single delay describes "
        "the sensor; use the phases, or a model"},
    Row{ResultFlag::closure_open, "closure_open", "what must hold over the run does not",
        "two things that were measured independently of each other disagree by more than chance "
        "and the tolerances of instruments leave them; its sentence says which, and what to do"},
    Row{ResultFlag::two_writers, "two_writers", "another program sends in its name",
        "blocks of the same session of this source came from two programs; those of the one that "
        "was there first were used, and nothing shows that it is the instrument; end the other "
        "one, which dyncal doctor names, and repeat the step",
        true},
    Row{ResultFlag::from_message, "other", "",
        "a newer version of dyncal made this result; its sentence says what it found"},
};

const Row& row_of(ResultFlag flag) {
  return rows.at(static_cast<std::size_t>(flag));
}

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (static_cast<std::size_t>(rows[i].kind) != i) {
      return false;
    }
  }
  return rows.size() == static_cast<std::size_t>(ResultFlag::from_message) + 1;
}
static_assert(is_in_order(), "one row for every flag, in the order of the enum");

} // namespace

const char* to_string(ResultFlag flag) {
  return row_of(flag).sentence;
}

std::string_view name_of(ResultFlag flag) {
  return row_of(flag).name;
}

ResultFlag parse_flag_name(std::string_view name) {
  const auto found = std::ranges::find(rows, name, &Row::name);
  return found == rows.end() ? ResultFlag::from_message : found->kind;
}

std::string_view explanation_of(ResultFlag flag) {
  return row_of(flag).explanation;
}

bool may_be_cured(ResultFlag flag) {
  return row_of(flag).may_be_cured;
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

Flag flag_of_channel(ResultFlag kind, const std::string& channel, const std::string& reason) {
  return {kind, channel + ": " + to_string(kind) + ": " + reason};
}

bool has_flag(const std::vector<Flag>& flags, ResultFlag kind) {
  return std::ranges::find(flags, kind, &Flag::kind) != flags.end();
}

std::vector<std::string> sentences_of(const std::vector<Flag>& flags) {
  std::vector<std::string> sentences;
  std::ranges::transform(flags, std::back_inserter(sentences),
                         [](const Flag& flag) { return flag.sentence; });
  return sentences;
}

std::vector<std::string> names_of(const std::vector<Flag>& flags) {
  std::vector<std::string> names;
  std::ranges::transform(flags, std::back_inserter(names),
                         [](const Flag& flag) { return std::string(name_of(flag.kind)); });
  return names;
}

std::vector<Flag> flags_from_message(const std::vector<std::string>& sentences,
                                     const std::vector<std::string>& names) {
  std::vector<Flag> flags;
  for (std::size_t i = 0; i < sentences.size(); ++i) {
    const ResultFlag kind = i < names.size() ? parse_flag_name(names[i]) : ResultFlag::from_message;
    flags.push_back({kind, sentences[i]});
  }
  return flags;
}

} // namespace dyncal::inline evaluation
