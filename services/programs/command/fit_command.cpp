// `dyncal fit DATA.csv`: one sine approximation (paper eq. (1)) of a recorded series, for checking.
//
// With a frequency three parameters are fitted, without one four, the frequency shared by all
// columns. Phase is lead at the reference time: y = amplitude sin(w (t - t_ref) + phase_rad).
// Prints a table, or JSON with 17 digits. Belongs to one thread.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "analysis/clock/stamp_beat.hpp"
#include "analysis/sine/disturbances.hpp"
#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/frequency_estimate.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/sine_residuals.hpp"
#include "analysis/sine/stamp_scatter.hpp"
#include "analysis/uncertainty/found_resolution.hpp"
#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/base/rounding.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/replay/series_file.hpp"

namespace dyncal::inline programs {
namespace {

struct FitOptions {
  std::filesystem::path file;
  std::string frequency;                         // decimal text; empty: estimated
  std::vector<std::string> columns;              // empty: all
  std::optional<std::int64_t> reference_time_ns; // default: the first stamp
  int drift = 0;
  int harmonics = 1;                     // highest harmonic in the model
  std::vector<std::string> hum;          // decimal text of further lines
  std::optional<double> nominal_rate_hz; // the stamps are replaced by n / rate (paper section 3)
  bool json = false;
};

void add_fit(CLI::App& command, FitOptions& fit) {
  command
      .add_option("DATA.csv", fit.file,
                  "CSV with a header line, or .npy: column t_ns, further columns")
      ->required();
  command.add_option("--frequency", fit.frequency,
                     "in Hz (default: estimated as fourth parameter)");
  command.add_option("--column", fit.columns, "column to fit (repeatable; default: all)");
  command.add_option("--reference-time", fit.reference_time_ns,
                     "instant at which the phase is given, in ns (default: the first stamp)");
  add_checked(command, "--drift", fit.drift, "highest power of a drift beside the sine",
              CLI::Range(0, 8));
  add_checked(command, "--harmonics", fit.harmonics, "highest harmonic beside the sine",
              CLI::Range(1, 50));
  command.add_option("--hum", fit.hum, "frequency of a further line in Hz (repeatable)");
  add_checked(command, "--nominal-rate", fit.nominal_rate_hz,
              "replace the file's stamps by those of this rate in Hz", CLI::PositiveNumber);
  command.add_flag("--json", fit.json, "print JSON");
}

// The estimate is good to this many bins 1/T (analysis/sine/frequency_estimate.hpp).
constexpr double estimate_bins = 1.5;
// Part of u of an amplitude from which on it is corrected for scatter of the stamps.
constexpr double worth_correcting = 0.1;

struct Fit {
  analysis::Frequency frequency = analysis::Frequency::from_hz(1.0); // until it is known
  std::optional<double> u_frequency_hz;
  std::int64_t reference_ns = 0;
  std::size_t out_of_order = 0; // samples left out for their stamps
  std::vector<std::string> names;
  std::vector<analysis::SineFit> fits;
  std::vector<double> shortening_rel; // put back, for each of them; 0: nothing to be seen
};

Expected<std::vector<std::span<const double>>>
chosen_columns(const SeriesFile& series, const std::vector<std::string>& names) {
  std::vector<std::span<const double>> columns;
  for (const std::string& name : names) {
    DYNCAL_TRY(columns.emplace_back(), series.column(name));
  }
  return columns;
}

// The stamps of the nominal rate: what a sensor's user without time stamps would assume.
void replace_stamps(double rate_hz, std::vector<std::int64_t>& stamps_ns) {
  for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
    stamps_ns[i] = std::llround(static_cast<double>(i) * 1e9 / rate_hz);
  }
}

analysis::Expected<analysis::ExtendedBasis> basis_of(const FitOptions& command) {
  analysis::ExtendedBasis basis;
  basis.drift_order = command.drift;
  basis.max_harmonic = command.harmonics;
  for (const std::string& text : command.hum) {
    DYNCAL_TRY(const auto line, analysis::Frequency::parse(text));
    basis.lines.push_back(line);
  }
  return basis;
}

analysis::Expected<void> find_frequency(const FitOptions& command, const SeriesFile& series,
                                        const std::vector<std::span<const double>>& columns,
                                        WorkCount& count, Fit& fit) {
  if (!command.frequency.empty()) {
    return analysis::Frequency::parse(command.frequency)
        .map([&](const analysis::Frequency& frequency) { fit.frequency = frequency; });
  }
  count.begin("estimating the frequency", "columns", columns.size());
  const auto start = analysis::estimate_frequency(series.stamps_ns, columns,
                                                  [&](double /*share*/) { count.add_done(); });
  if (!start) {
    const bool no_sine = start.error().code == analysis::ErrorCode::no_excitation;
    return fail(start.error().code,
                start.error().message + (no_sine ? "; if you know its frequency, give --frequency, "
                                                   "and --column for the columns that have it"
                                                 : ""));
  }
  const double duration_s =
      static_cast<double>(series.stamps_ns.back() - series.stamps_ns.front()) * 1e-9;
  const double search_rel = std::min(estimate_bins / (start->hz() * duration_s), 0.9);
  count.begin("fitting the frequency", "", 0);
  return analysis::fit_sine_and_frequency(*start, search_rel, fit.reference_ns, series.stamps_ns,
                                          columns)
      .map([&](analysis::FrequencyFit found) {
        fit.frequency = found.frequency;
        fit.u_frequency_hz = found.u_frequency_hz;
        fit.fits = std::move(found.channels);
      });
}

analysis::Expected<void> fit_columns(const FitOptions& command, const SeriesFile& series,
                                     const std::vector<std::span<const double>>& columns,
                                     WorkCount& count, Fit& fit) {
  DYNCAL_TRY(const auto basis, basis_of(command));
  if (basis.drift_order == 0 && basis.max_harmonic <= 1 && basis.lines.empty()) {
    if (!fit.fits.empty()) {
      return {};
    }
    count.begin("fitting", "", 0);
    return analysis::fit_sine(fit.frequency, fit.reference_ns, series.stamps_ns, columns)
        .map([&](auto fits) { fit.fits = std::move(fits); });
  }
  count.begin_share("fitting");
  return analysis::fit_sine_extended(fit.frequency, basis, analysis::Weighting::none,
                                     fit.reference_ns, series.stamps_ns, columns,
                                     [&](double share) { count.set_share_done(share); })
      .map([&](const std::vector<analysis::ExtendedFit>& fits) {
        fit.fits.clear();
        for (const analysis::ExtendedFit& one : fits) {
          fit.fits.push_back(one.fundamental);
        }
      });
}

// The amplitude without what scatter of the stamps took off it, and what is not known of that.
void lengthen(const analysis::StampScatter& scatter, analysis::SineFit& fit) {
  const double factor = 1.0 / (1.0 - scatter.correction_rel());
  const double u_rel = scatter.u_correction_rel();
  fit.sine *= factor;
  fit.cosine *= factor;
  fit.covariance[0] += std::pow(u_rel * fit.sine, 2);
  fit.covariance[1] += u_rel * u_rel * fit.sine * fit.cosine;
  fit.covariance[3] += std::pow(u_rel * fit.cosine, 2);
}

// Each column is looked at beside its harmonics, hum and drift, which are no scatter. Where that
// cannot be fitted, nothing is corrected.
void correct_scatter(const SeriesFile& series, const std::vector<std::span<const double>>& columns,
                     Fit& fit) {
  fit.shortening_rel.assign(columns.size(), 0.0);
  const std::int64_t middle_ns = analysis::middle_of_record_ns(series.stamps_ns);
  const auto beside =
      analysis::fit_sine_beside_disturbances(fit.frequency, middle_ns, series.stamps_ns, columns);
  for (std::size_t i = 0; beside && i < columns.size(); ++i) {
    const analysis::CleanedFit& clean = (*beside)[i];
    const std::span<const double> values =
        clean.values.empty() ? columns[i] : std::span<const double>(clean.values);
    const analysis::StampScatter scatter = analysis::measure_stamp_scatter(
        fit.frequency, clean.fit, middle_ns, series.stamps_ns, values,
        analysis::found_resolution(columns[i]), analysis::SlowScatter::counts);
    analysis::SineFit& one = fit.fits[i];
    if (scatter.correction_rel() * one.amplitude() > worth_correcting * one.u_amplitude()) {
      fit.shortening_rel[i] = scatter.correction_rel();
      lengthen(scatter, one);
    }
  }
}

// What errors of the stamps that are in step with the sine may do to it, in any direction.
void allow_for_beat(const SeriesFile& series, Fit& fit) {
  const double bound_rel = analysis::stamp_beat(fit.frequency, series.stamps_ns).in_step_rad;
  for (analysis::SineFit& one : fit.fits) {
    const double variance = std::pow(bound_rel * one.amplitude(), 2) / 3.0;
    one.covariance[0] += variance;
    one.covariance[3] += variance;
  }
}

void print_json(const Fit& fit) {
  nlohmann::ordered_json columns = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const analysis::SineFit& one = fit.fits[i];
    columns[fit.names[i]] = {{"A_sin", one.sine},
                             {"B_cos", one.cosine},
                             {"C", one.offset},
                             {"u_A", std::sqrt(one.covariance[0])},
                             {"u_B", std::sqrt(one.covariance[3])},
                             {"u_C", std::sqrt(one.covariance[5])},
                             {"amplitude", one.amplitude()},
                             {"phase_rad", one.phase_rad()},
                             {"u_amplitude", one.u_amplitude()},
                             {"u_phase_rad", one.u_phase_rad()},
                             {"phase_deg", one.phase_rad() * 180.0 / std::numbers::pi},
                             {"u_phase_deg", one.u_phase_rad() * 180.0 / std::numbers::pi},
                             {"covariance", one.covariance}, // AA, AB, AC, BB, BC, CC
                             {"rss", one.rss},
                             {"samples", one.samples}};
    if (fit.shortening_rel[i] > 0.0) {
      columns[fit.names[i]]["corrected_shortening_rel"] = fit.shortening_rel[i];
    }
  }
  nlohmann::ordered_json json{{"frequency_hz", fit.frequency.hz()}};
  if (fit.u_frequency_hz) {
    json["u_frequency_hz"] = *fit.u_frequency_hz;
  }
  json["reference_time_ns"] = fit.reference_ns;
  json["out_of_order"] = fit.out_of_order;
  json["columns"] = std::move(columns);
  fmt::print("{}\n", json_text(json, 1));
}

void print_table(const Fit& fit) {
  const double frequency_hz = fit.frequency.hz();
  if (fit.u_frequency_hz) {
    const RoundedValue frequency = round_by_uncertainty(frequency_hz, *fit.u_frequency_hz);
    fmt::print("frequency {} Hz (u {} Hz)", frequency.value, frequency.u);
  } else {
    fmt::print("frequency {} Hz", frequency_hz);
  }
  fmt::print(", reference time {} ns\n", fit.reference_ns);
  if (fit.out_of_order > 0) {
    fmt::print("{} samples left out, their stamps do not rise\n", fit.out_of_order);
  }
  fmt::print("{:>20} {:>16} {:>10} {:>16} {:>10} {:>14} {:>10} {:>10}\n", "column", "amplitude",
             "u", "phase / rad", "u / rad", "offset", "u", "samples");
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const analysis::SineFit& one = fit.fits[i];
    const RoundedValue amplitude = round_by_uncertainty(one.amplitude(), one.u_amplitude());
    const RoundedValue phase = round_phase(one.phase_rad(), one.u_phase_rad()).radians;
    const RoundedValue offset = round_by_uncertainty(one.offset, std::sqrt(one.covariance[5]));
    fmt::print("{:>20} {:>16} {:>10} {:>16} {:>10} {:>14} {:>10} {:>10}\n", one_line(fit.names[i]),
               amplitude.value, amplitude.u, phase.value, phase.u, offset.value, offset.u,
               one.samples);
  }
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    if (fit.shortening_rel[i] > 0.0) {
      fmt::print("{}: its stamps scatter or its phase wanders, which had shortened the sine by "
                 "{:.2g} %; corrected\n",
                 one_line(fit.names[i]), 100.0 * fit.shortening_rel[i]);
    }
  }
}

Expected<Fit> fit_file(const FitOptions& command) {
  const WorkProgress progress("reading");
  DYNCAL_TRY(auto series,
             read_series_file(command.file, progress.count(), command.nominal_rate_hz));
  Fit fit;
  if (command.nominal_rate_hz) {
    replace_stamps(*command.nominal_rate_hz, series.stamps_ns);
  } else {
    fit.out_of_order = series.leave_out_disorder();
  }
  fit.names = command.columns.empty() ? series.names : command.columns;
  DYNCAL_TRY(const auto columns, chosen_columns(series, fit.names));
  if (series.stamps_ns.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the file has no samples", command.file.string()));
  }
  fit.reference_ns = command.reference_time_ns.value_or(series.stamps_ns.front());
  WorkCount& count = *progress.count();
  const auto fitted = find_frequency(command, series, columns, count, fit).and_then([&] {
    return fit_columns(command, series, columns, count, fit);
  });
  if (!fitted) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: {}", command.file.string(), fitted.error().message));
  }
  correct_scatter(series, columns, fit);
  allow_for_beat(series, fit);
  return fit;
}

Expected<void> run_fit(const FitOptions& command) {
  DYNCAL_TRY(const auto fit, fit_file(command));
  command.json ? print_json(fit) : print_table(fit);
  return {};
}

const Command fit_command{240, "fit", "one sine approximation of a recorded series, for checking",
                          add_fit, run_fit};

} // namespace
} // namespace dyncal::inline programs
