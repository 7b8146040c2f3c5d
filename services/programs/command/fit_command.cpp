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
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "analysis/method/record_fit.hpp"
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

struct Fit {
  analysis::RecordFit record;
  std::size_t out_of_order = 0; // samples left out for their stamps
  std::vector<std::string> names;
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

analysis::Expected<analysis::RecordFitSettings> settings_of(const FitOptions& command) {
  analysis::RecordFitSettings settings;
  settings.phase_origin_ns = command.reference_time_ns;
  settings.basis.drift_order = command.drift;
  settings.basis.max_harmonic = command.harmonics;
  for (const std::string& text : command.hum) {
    DYNCAL_TRY(const auto line, analysis::Frequency::parse(text));
    settings.basis.lines.push_back(line);
  }
  if (!command.frequency.empty()) {
    DYNCAL_TRY(settings.frequency, analysis::Frequency::parse(command.frequency));
  }
  return settings;
}

analysis::Expected<analysis::RecordFit>
fit_series(const FitOptions& command, const SeriesFile& series,
           const std::vector<std::span<const double>>& columns, WorkCount& count) {
  DYNCAL_TRY(const auto settings, settings_of(command));
  const analysis::RecordFitStages begin = [&](std::string_view stage) -> analysis::Progress {
    count.begin(std::string(stage), "", 0);
    return [&count, stage = std::string(stage), has_share = false](double share) mutable {
      if (!std::exchange(has_share, true)) {
        count.begin_share(stage);
      }
      count.set_share_done(share);
    };
  };
  auto record = analysis::fit_record(settings, series.stamps_ns, columns, begin);
  if (!record && command.frequency.empty() &&
      record.error().code == analysis::ErrorCode::no_excitation) {
    return fail(record.error().code, record.error().message +
                                         "; if you know its frequency, give --frequency, and "
                                         "--column for the columns that have it");
  }
  return record;
}

void print_json(const Fit& fit) {
  nlohmann::ordered_json columns = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const analysis::SineFit& one = fit.record.fits[i];
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
    if (fit.record.shortening_rel[i] > 0.0) {
      columns[fit.names[i]]["corrected_shortening_rel"] = fit.record.shortening_rel[i];
    }
  }
  nlohmann::ordered_json json{{"frequency_hz", fit.record.frequency.hz()}};
  if (fit.record.u_frequency_hz) {
    json["u_frequency_hz"] = *fit.record.u_frequency_hz;
  }
  json["reference_time_ns"] = fit.record.phase_origin_ns;
  json["out_of_order"] = fit.out_of_order;
  json["columns"] = std::move(columns);
  fmt::print("{}\n", json_text(json, 1));
}

void print_table(const Fit& fit) {
  const double frequency_hz = fit.record.frequency.hz();
  if (fit.record.u_frequency_hz) {
    const RoundedValue frequency = round_by_uncertainty(frequency_hz, *fit.record.u_frequency_hz);
    fmt::print("frequency {} Hz (u {} Hz)", frequency.value, frequency.u);
  } else {
    fmt::print("frequency {} Hz", frequency_hz);
  }
  fmt::print(", reference time {} ns\n", fit.record.phase_origin_ns);
  if (fit.out_of_order > 0) {
    fmt::print("{} samples left out, their stamps do not rise\n", fit.out_of_order);
  }
  fmt::print("{:>20} {:>16} {:>10} {:>16} {:>10} {:>14} {:>10} {:>10}\n", "column", "amplitude",
             "u", "phase / rad", "u / rad", "offset", "u", "samples");
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    const analysis::SineFit& one = fit.record.fits[i];
    const RoundedValue amplitude = round_by_uncertainty(one.amplitude(), one.u_amplitude());
    const RoundedValue phase = round_phase(one.phase_rad(), one.u_phase_rad()).radians;
    const RoundedValue offset = round_by_uncertainty(one.offset, std::sqrt(one.covariance[5]));
    fmt::print("{:>20} {:>16} {:>10} {:>16} {:>10} {:>14} {:>10} {:>10}\n", one_line(fit.names[i]),
               amplitude.value, amplitude.u, phase.value, phase.u, offset.value, offset.u,
               one.samples);
  }
  for (std::size_t i = 0; i < fit.names.size(); ++i) {
    if (fit.record.shortening_rel[i] > 0.0) {
      fmt::print("{}: its stamps scatter or its phase wanders, which had shortened the sine by "
                 "{:.2g} %; corrected\n",
                 one_line(fit.names[i]), 100.0 * fit.record.shortening_rel[i]);
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
  auto record = fit_series(command, series, columns, *progress.count());
  if (!record) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: {}", command.file.string(), record.error().message));
  }
  fit.record = *std::move(record);
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
