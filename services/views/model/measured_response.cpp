#include "services/views/model/measured_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/byte_count.hpp"
#include "services/evaluation/shared_phase_uncertainty.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {
namespace {

constexpr double max_u_phase_rad = 0.5;
constexpr double max_u_magnitude_rel = 0.3;

// All that is known of one value of the transfer function before what is common is told apart.
struct RawValue {
  MeasuredValue value;
  const StoredValue* transfer = nullptr;
  std::vector<const StoredPoint*> repetitions;
};

// A model is fitted to just those phases that lie on no line from 0 or 180 degrees at 0 Hz.
bool describes_all_that_is_open(const StoredResult& contents, const std::string& channel) {
  const std::vector<Closure> closures = contents.closures_of(channel);
  return std::all_of(closures.begin(), closures.end(), [](const Closure& one) {
    return !is_open(one) || one.kind == ClosureKind::delay_fit ||
           one.kind == ClosureKind::phase_at_zero;
  });
}

std::vector<std::string> flags_for_a_model(const StoredResult& contents, const StoredValue& value) {
  std::vector<std::string> flags = value.flag_names;
  if (describes_all_that_is_open(contents, value.channel)) {
    std::erase(flags, "closure_open");
  }
  return flags;
}

std::optional<std::string> reason_to_leave_out(const StoredResult& contents,
                                               const StoredValue& value,
                                               const ResponseSelection& selection) {
  if (!std::isfinite(value.magnitude) || !std::isfinite(value.phase_rad) ||
      !(value.magnitude > 0.0)) {
    return "it has no value";
  }
  if (value.of_phase.expanded > 2.0 * max_u_phase_rad ||
      value.of_magnitude.expanded > 2.0 * max_u_magnitude_rel * value.magnitude) {
    return "its u is too large to be of use";
  }
  if (!selection.include_flagged) {
    for (const std::string& flag : flags_for_a_model(contents, value)) {
      if (makes_unusable(flag)) {
        return fmt::format("flag {}", flag);
      }
    }
  }
  return std::nullopt;
}

Expected<void> check_uncertainty(const StoredResult& contents, const StoredValue& value) {
  const auto wrong = [&](const char* key, double u) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: {} at {} Hz has {} = {}; a fit weighs with it, so it must be "
                            "above 0: state the uncertainties in the bench file and evaluate again",
                            contents.file.string(), value.channel, value.frequency_text_hz, key,
                            std::isfinite(u) ? fmt::format("{:g}", u) : "null"));
  };
  if (!(value.of_magnitude.expanded > 0.0)) {
    return wrong("U_magnitude", value.of_magnitude.expanded);
  }
  if (!(value.of_phase.expanded > 0.0)) {
    return wrong("U_phase_rad", value.of_phase.expanded);
  }
  if (!(value.frequency_hz > 0.0)) {
    return wrong("frequency_hz", value.frequency_hz);
  }
  return {};
}

RawValue raw_value(const StoredResult& contents, const StoredValue& transfer) {
  RawValue raw;
  raw.transfer = &transfer;
  raw.value.file = contents.file.string();
  raw.value.frequency_text_hz = transfer.frequency_text_hz;
  raw.value.point.frequency_hz = transfer.frequency_hz;
  raw.value.point.h = std::polar(transfer.magnitude, transfer.phase_rad);
  raw.value.u_magnitude_rel = 0.5 * transfer.of_magnitude.expanded / transfer.magnitude;
  raw.value.u_phase_rad = 0.5 * transfer.of_phase.expanded;
  raw.value.flag_names = flags_for_a_model(contents, transfer);
  for (const StoredPoint& point : contents.points) {
    if (point.valid && point.channel == transfer.channel &&
        point.frequency_hz == transfer.frequency_hz && point.level_m_s2 == transfer.level_m_s2 &&
        !point.budget.empty()) {
      raw.repetitions.push_back(&point);
    }
  }
  return raw;
}

// U / 2 of each mean's magnitude without what repeats.
std::vector<double> drawn_anew_magnitude_rel(const std::vector<RawValue>& raw) {
  std::vector<analysis::RepeatedFrequency> repeated;
  for (const RawValue& one : raw) {
    repeated.push_back({one.value.point.frequency_hz, {}});
    for (const StoredPoint* point : one.repetitions) {
      analysis::Repetition repetition =
          analysis::make_repetition(std::polar(point->magnitude, point->phase_rad), point->budget);
      repetition.u_common_magnitude_rel = repetition.u_common_phase_rad = 0.0;
      repeated.back().repetitions.push_back(repetition);
    }
  }
  const auto means = analysis::means_of_repetitions(repeated);
  std::vector<double> result;
  result.reserve(raw.size());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    result.push_back(means[i] ? means[i]->u_magnitude / means[i]->magnitude
                              : raw[i].value.u_magnitude_rel);
  }
  return result;
}

// What a value has beyond what is independent: of the reference, and of the rest. Squares.
struct RepeatingMagnitude {
  double reference2 = 0.0;
  double other2 = 0.0;
};

RepeatingMagnitude repeating_magnitude(const RawValue& raw) {
  RepeatingMagnitude result;
  for (const analysis::Contribution& row : raw.repetitions.front()->budget) {
    if (row.repeats == analysis::Repeats::anew) {
      result.other2 += std::pow(row.u_lasting_magnitude_rel, 2);
    } else if (row.kind == analysis::ContributionKind::reference) {
      result.reference2 += std::pow(row.u_magnitude_rel, 2);
    } else {
      result.other2 += std::pow(row.u_magnitude_rel, 2);
    }
  }
  return result;
}

void divide_magnitudes(std::vector<RawValue>& raw, MeasuredResponse& response) {
  const std::vector<double> anew = drawn_anew_magnitude_rel(raw);
  std::vector<RepeatingMagnitude> repeating;
  double gain2 = std::numeric_limits<double>::infinity();
  for (const RawValue& one : raw) {
    repeating.push_back(repeating_magnitude(one));
    gain2 = std::min(gain2, repeating.back().reference2);
  }
  response.common.gain_rel = std::sqrt(gain2);
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const double beyond2 = repeating[i].other2 + repeating[i].reference2 - gain2;
    raw[i].value.point.u_magnitude_rel = std::sqrt(anew[i] * anew[i] + std::max(0.0, beyond2));
  }
}

void divide_phases(std::vector<RawValue>& raw, MeasuredResponse& response) {
  std::vector<BudgetAtFrequency> budgets;
  budgets.reserve(raw.size());
  for (const RawValue& one : raw) {
    budgets.push_back({one.value.point.frequency_hz, one.repetitions.front()->budget});
  }
  const SharedPhaseUncertainty shared = shared_phase_uncertainty(budgets);
  response.common.delay_s = shared.common.delay_s;
  response.common.phase_rad = shared.common.phase_rad;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const double anew = raw[i].transfer->u_independent_phase_rad;
    raw[i].value.point.u_phase_rad =
        std::hypot(std::isfinite(anew) ? anew : raw[i].value.u_phase_rad, shared.beyond_rad[i]);
  }
}

// Of the part `u_own` of u: what else there is in u is known well (GUM G.4).
double own_degrees_of_freedom(double degrees_of_freedom, double u_own, double u) {
  return std::max(1.0, degrees_of_freedom * std::pow(std::min(1.0, u_own / u), 4));
}

void divide_uncertainties(std::vector<RawValue>& raw, MeasuredResponse& response) {
  response.has_budgets =
      std::ranges::all_of(raw, [](const RawValue& one) { return !one.repetitions.empty(); });
  if (response.has_budgets) {
    divide_magnitudes(raw, response);
    divide_phases(raw, response);
  }
  for (RawValue& one : raw) {
    analysis::ResponsePoint& point = one.value.point;
    if (!(point.u_magnitude_rel > 0.0)) { // no budget, or nothing in it that is independent
      point.u_magnitude_rel = one.value.u_magnitude_rel;
    }
    if (!(point.u_phase_rad > 0.0)) {
      point.u_phase_rad = one.value.u_phase_rad;
    }
    point.magnitude_degrees_of_freedom = own_degrees_of_freedom(
        one.transfer->of_magnitude.nu_eff, point.u_magnitude_rel, one.value.u_magnitude_rel);
    point.phase_degrees_of_freedom = own_degrees_of_freedom(
        one.transfer->of_phase.nu_eff, point.u_phase_rad, one.value.u_phase_rad);
    response.values.push_back(std::move(one.value));
  }
}

Expected<void> check_units(const MeasuredResponse& response, const std::string& first_file,
                           const StoredResult& contents, const StoredValue& value) {
  if (value.unit == response.unit) {
    return {};
  }
  return fail(
      ErrorCode::bad_file,
      fmt::format("{}: {} is in '{}' but in '{}' in {}; values in different units cannot "
                  "be fitted together: state the units in the bench file and evaluate again",
                  contents.file.string(), value.channel, value.unit, response.unit, first_file));
}

Expected<MeasuredResponse> read_channel(const std::vector<StoredResult>& files,
                                        const std::string& channel,
                                        const ResponseSelection& selection) {
  MeasuredResponse response;
  response.channel = channel;
  std::vector<RawValue> raw;
  const StoredResult* first = nullptr;
  for (const StoredResult& contents : files) {
    for (const StoredValue& value : contents.values) {
      if (value.channel != channel) {
        continue;
      }
      if (first == nullptr) {
        first = &contents;
        response.unit = value.unit;
      }
      DYNCAL_TRY(check_units(response, first->file.string(), contents, value));
      if (const auto reason = reason_to_leave_out(contents, value, selection)) {
        response.left_out.push_back({contents.file.string(), value.frequency_text_hz, *reason});
        continue;
      }
      DYNCAL_TRY(check_uncertainty(contents, value));
      raw.push_back(raw_value(contents, value));
    }
    for (const ClockReport& report : contents.clocks) {
      const double rate_hz = report.clock.mean_rate_hz;
      if (channel.starts_with(report.source + "/") && rate_hz > 0.0 &&
          response.sample_rate_hz == 0.0) {
        response.sample_rate_hz = rate_hz;
      }
    }
  }
  divide_uncertainties(raw, response);
  return response;
}

// In the order of the files.
std::vector<std::string> channels_of(const std::vector<StoredResult>& files) {
  std::vector<std::string> channels;
  for (const StoredResult& contents : files) {
    for (const StoredChannel& one : contents.channels) {
      if (one.responds && std::ranges::find(channels, one.channel) == channels.end()) {
        channels.push_back(one.channel);
      }
    }
  }
  return channels;
}

std::string file_names(const std::vector<StoredResult>& files) {
  std::vector<std::string> names;
  std::ranges::transform(files, std::back_inserter(names),
                         [](const StoredResult& contents) { return contents.file.string(); });
  return fmt::format("{}", fmt::join(names, ", "));
}

Expected<void> check_channels(const std::vector<StoredResult>& files,
                              const std::vector<std::string>& asked) {
  std::vector<std::string> known;
  for (const StoredResult& contents : files) {
    for (const StoredValue& value : contents.values) {
      if (std::ranges::find(known, value.channel) == known.end()) {
        known.push_back(value.channel);
      }
    }
  }
  for (const std::string& channel : asked) {
    if (std::ranges::find(known, channel) == known.end()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("{}: there is no channel '{}'; the channels are: {}",
                              file_names(files), channel, fmt::join(known, ", ")));
    }
  }
  return {};
}

} // namespace

std::vector<analysis::ResponsePoint> MeasuredResponse::points() const {
  std::vector<analysis::ResponsePoint> result;
  std::ranges::transform(values, std::back_inserter(result),
                         [](const MeasuredValue& value) { return value.point; });
  return result;
}

bool makes_unusable(const std::string& flag_name) {
  // What u holds, and what concerns a whole channel. All others, and those that a newer version
  // may have added, say that a value may be wrong beyond u.
  constexpr std::array usable{"samples_lost",
                              "stamps_not_trusted",
                              "values_not_measured",
                              "shorter_than_planned",
                              "clock_uncertainty_unknown",
                              "excitation_broken_off",
                              "level_off_plan",
                              "settling_not_found",
                              "shots_missing",
                              "shots_left_out",
                              "records_lost",
                              "start_undecided",
                              "trigger_phase_not_corrected",
                              "no_monte_carlo_check",
                              "polarity_inverted",
                              "answers_before_excitation",
                              "adc_not_calibrated",
                              "reference_uncertainty_not_stated",
                              "disturbance_cut_out",
                              "stamps_scatter",
                              "trigger_delay_not_stated",
                              "acs_delay_not_stated",
                              "group_delay_ambiguous",
                              "group_delay_not_constant"};
  return std::ranges::find(usable, flag_name) == usable.end();
}

Expected<std::vector<MeasuredResponse>>
read_responses(const std::vector<std::filesystem::path>& files, const ResponseSelection& selection,
               const SharedWorkCount& count) {
  ByteCount bytes(count, "reading", bytes_of_files(files));
  std::vector<StoredResult> contents;
  std::set<std::filesystem::path> read;
  for (const std::filesystem::path& file : files) {
    std::error_code ignored;
    if (!read.insert(std::filesystem::weakly_canonical(file, ignored)).second) {
      return fail(
          ErrorCode::bad_argument,
          fmt::format("{}: this result is given twice, and would count twice", file.string()));
    }
    DYNCAL_TRY(auto one, read_values(file, bytes));
    contents.push_back(std::move(one));
  }
  DYNCAL_TRY(check_channels(contents, selection.channels));
  const std::vector<std::string> channels =
      selection.channels.empty() ? channels_of(contents) : selection.channels;
  if (channels.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: no channel responds to the excitation; --channel names one that "
                            "is fitted anyway",
                            file_names(contents)));
  }
  std::vector<MeasuredResponse> responses;
  for (const std::string& channel : channels) {
    DYNCAL_TRY(auto response, read_channel(contents, channel, selection));
    responses.push_back(std::move(response));
  }
  return responses;
}

} // namespace dyncal::inline views
