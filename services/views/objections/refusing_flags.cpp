#include "services/views/objections/refusing_flags.hpp"

#include <array>
#include <vector>

#include "services/evaluation/result/point_identity.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline views {
namespace {

struct Row {
  ResultFlag flag;
  bool forbids;
  std::string_view reason;
  bool of_phase_alone = false;
};

// In the order of the enum.
constexpr std::array rows{
    Row{ResultFlag::samples_lost, true,
        "samples of the step are missing, and nothing says that those that came are like them"},
    Row{ResultFlag::stamps_not_trusted, false,
        "samples without a trusted stamp were left out, and why is known; U is of the others"},
    Row{ResultFlag::values_not_measured, false,
        "samples that the device marked as not measured were left out; U is of the others"},
    Row{ResultFlag::shorter_than_planned, false, "less was recorded, and U is larger for it"},
    Row{ResultFlag::clock_uncertainty_unknown, true,
        "U of the phase lacks the uncertainty of the time stamps", true},
    Row{ResultFlag::excitation_broken_off, true, "the step was not finished"},
    Row{ResultFlag::step_number_uncertain, false,
        "the value holds for its frequency and level; which repetition it is, is not known"},
    Row{ResultFlag::level_off_plan, false,
        "the value holds for the level that the reference measured, which is stated"},
    Row{ResultFlag::over_range, true, "a sine that is cut off is wrong by more than U"},
    Row{ResultFlag::values_stuck, true, "a channel that repeats a value is wrong by more than U"},
    Row{ResultFlag::distorted, true,
        "the excitation is outside the distortion that ISO 16063-21 allows"},
    Row{ResultFlag::settling_not_found, false,
        "the planned settling time was left out instead of the one found"},
    Row{ResultFlag::settles_too_long, true,
        "the sine was not steady when the evaluation began, which U does not hold"},
    Row{ResultFlag::shots_missing, false, "fewer shots were evaluated, and U is larger for it"},
    Row{ResultFlag::shots_left_out, true, "the settings of an instrument changed within the step"},
    Row{ResultFlag::records_lost, true,
        "records of shots are missing, and nothing says that those that came are like them"},
    Row{ResultFlag::start_undecided, false, "U allows for both ways in which the series may start"},
    Row{ResultFlag::trigger_phase_not_corrected, true,
        "noise and threshold of the trigger are left in the phase"},
    Row{ResultFlag::no_monte_carlo_check, false,
        "the value stands without the cross-check, which the certificate then does not claim"},
    Row{ResultFlag::polarity_inverted, false,
        "the phase is stated as it was measured, with the inversion"},
    Row{ResultFlag::answers_before_excitation, true,
        "a negative group delay says that a role or a correction is wrong"},
    Row{ResultFlag::adc_not_calibrated, true,
        "U of the phase lacks the delay of the ADC that records sync", true},
    Row{ResultFlag::reference_uncertainty_not_stated, true,
        "U lacks the uncertainty of the reference, so the value is not traceable"},
    Row{ResultFlag::mains_not_separated, true, "U holds nothing for hum at this frequency"},
    Row{ResultFlag::harmonic_not_separated, true,
        "U holds nothing for the distortion that falls on this frequency"},
    Row{ResultFlag::signal_not_judged, false,
        "value and U stand without the check of range and distortion"},
    Row{ResultFlag::peaks_bent, true, "a sine whose peaks are bent is wrong by more than U"},
    Row{ResultFlag::changed_within_step, true,
        "the value is a mean over two states of the sensor or of the recording"},
    Row{ResultFlag::disturbance_cut_out, false,
        "a short disturbance was left out; U is of the other samples"},
    Row{ResultFlag::clock_stepped, true,
        "stamps on both sides of the jump are not of one time scale"},
    Row{ResultFlag::stamps_scatter, false,
        "the shortening by scattered stamps was corrected, and U allows for it"},
    Row{ResultFlag::values_off_stamps, true, "the stamps do not say when the values were measured"},
    Row{ResultFlag::too_short_for_noise, true,
        "U rests on noise that the record is too short to show"},
    Row{ResultFlag::shots_disagree, true, "the shots are not repetitions of one measurement"},
    Row{ResultFlag::trigger_delay_not_stated, true, "U of the phase lacks the delay of the trigger",
        true},
    Row{ResultFlag::acs_delay_not_stated, true,
        "U of the phase lacks the delay between reference and sync in the ACS", true},
    Row{ResultFlag::group_delay_ambiguous, false,
        "phases are stated at each frequency; the delay is not certified"},
    Row{ResultFlag::group_delay_not_constant, false,
        "phases are stated at each frequency; the delay is not certified"},
    Row{ResultFlag::closure_open, true,
        "what was measured independently of the value disagrees with it"},
    Row{ResultFlag::two_writers, true,
        "two programs sent as one instrument, and nothing shows which of them it is"},
    Row{ResultFlag::from_message, true, "this version does not know the flag and cannot judge it"},
};

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (static_cast<std::size_t>(rows[i].flag) != i) {
      return false;
    }
  }
  return rows.size() == static_cast<std::size_t>(ResultFlag::from_message) + 1;
}
static_assert(is_in_order(), "one row for every flag, in the order of the enum");

} // namespace

FlagVerdict verdict_on(ResultFlag flag) {
  const Row& row = rows.at(static_cast<std::size_t>(flag));
  return {row.forbids, row.reason, row.of_phase_alone};
}

std::string doubting_flag(const StoredResult& result, const StoredValue& value, bool of_phase) {
  std::vector<std::string> names = value.flag_names;
  for (const StoredChannel& channel : result.channels) {
    if (channel.channel == value.channel) {
      names.insert(names.end(), channel.flag_names.begin(), channel.flag_names.end());
    }
  }
  for (const StoredPoint& point : result.points) {
    if (point.valid && mean_identity_of(point) == identity_of(value)) {
      names.insert(names.end(), point.flag_names.begin(), point.flag_names.end());
    }
  }
  for (const std::string& name : names) {
    const FlagVerdict verdict = verdict_on(parse_flag_name(name));
    if (verdict.forbids && (of_phase || !verdict.of_phase_alone)) {
      return name;
    }
  }
  return "";
}

} // namespace dyncal::inline views
