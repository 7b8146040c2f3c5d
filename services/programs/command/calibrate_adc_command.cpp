// `dyncal calibrate adc BENCH.toml`: the response of the DAU's sync ADC over frequency and test
// amplitude, in the path that calibrations use (data-ready edge, stamp, conversion), against the
// ACS's sync channel; analysis/instrument/adc_comparison.hpp has the model.
//
// Conducts one run of the bench's excitation list for each test amplitude, with sync itself as
// reference and as channel under calibration, and writes all measurements as a file that
// `[corrections] adc` reads. Without --amplitudes the bench's levels are used and the test
// amplitude is the one that the ACS finds. With them the generator is set to half of the
// peak-to-peak voltage, so sync must be its output. Needs both sources to stamp in UTC: anything
// else is refused, for an ADC's delay cannot be distinguished from an unknown offset of two
// clocks. An oscilloscope's record is refused as well: it is placed in time by its trigger, which
// the DAU does not stamp. Belongs to one thread.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <map>
#include <numbers>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "analysis/instrument/adc_comparison.hpp"
#include "drivers/utc_clock.hpp"
#include "services/bench/file/adc_file_writer.hpp"
#include "services/bench/file/bench_file.hpp"
#include "services/contract/time_name.hpp"
#include "services/contract/topics.hpp"
#include "services/daemon/program/bench_program.hpp"
#include "services/daemon/program/watched_network.hpp"
#include "services/programs/command/adc_bench.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/progress_line.hpp"
#include "services/run/run_controller.hpp"
#include "services/views/report/show_outcome.hpp"

namespace dyncal::inline programs {
namespace {

struct CalibrateAdcOptions {
  std::filesystem::path bench_file;
  std::filesystem::path output = "adc.json";
  std::string channel = "ADC1";       // its name in the file
  std::vector<double> amplitudes_vpp; // empty: one pass with the bench's levels
  double u_time_scale_s = 100e-9;     // of the two sources' stamps against each other
  double u_acs_gain_rel = 0.0;        // of the ACS's sync channel
  NetworkOptions network;
};

void add_adc(CLI::App& command, CalibrateAdcOptions& adc) {
  command
      .add_option("BENCH.toml", adc.bench_file,
                  "bench file: its frequencies and repetitions are measured")
      ->required();
  command
      .add_option("--amplitudes", adc.amplitudes_vpp,
                  "of sync, in V peak to peak, comma separated; the generator's output must be "
                  "sync (default: the bench's levels, one amplitude)")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  add_default(command, "--channel", adc.channel, "name of the ADC in the file");
  add_default(command, "--time-uncertainty", adc.u_time_scale_s,
              "standard uncertainty of the stamps of DAU and ACS against each other, in seconds "
              "(see calibrate time)",
              CLI::NonNegativeNumber);
  add_default(command, "--gain-uncertainty", adc.u_acs_gain_rel,
              "relative standard uncertainty of the ACS's sync channel", CLI::NonNegativeNumber);
  add_default(command, "--output", adc.output, "file that [corrections] adc of a bench file names");
  add_network_options(command, adc.network);
}

using namespace std::chrono_literals;
using Measurements = std::vector<analysis::AdcCalibrationPoint>;

constexpr auto description_limit = 6s;
constexpr double amplitude_tolerance =
    0.1; // of the sync voltage asked for; cables and loads take a little
constexpr double amplitude_spread = 0.05; // within one pass without a voltage asked for
constexpr double max_adc_delay_s = 2e-5;  // more is a hint at something else

// How the sources describe themselves, which takes precedence over the bench file.
Expected<void> require_common_time_scale(bus::Participant& participant, const BenchFile& bench,
                                         const std::stop_token& stop) {
  const auto wake_up = std::make_shared<bus::WakeUp>();
  DYNCAL_TRY(auto descriptions,
             participant.reader(bus::topics::source_description, bench.bench, wake_up));
  std::map<std::string, wire::TimeBase> time_bases;
  const std::array<std::string, 2> sources{bench.method.sync_acs.source,
                                           bench.method.sync_dau.source};
  const auto deadline = std::chrono::steady_clock::now() + description_limit;
  const auto missing = [&] {
    return std::find_if(sources.begin(), sources.end(),
                        [&](const std::string& source) { return time_bases.count(source) == 0; });
  };
  while (missing() != sources.end() && std::chrono::steady_clock::now() < deadline &&
         !stop.stop_requested()) {
    wake_up->wait_until(std::chrono::steady_clock::now() + 100ms);
    descriptions.take([&](const wire::SourceDescription& description) {
      time_bases[description.source().to_string()] = description.time_base();
    });
  }
  if (stop.stop_requested()) {
    return fail(ErrorCode::interrupted, "interrupted before the first step; nothing was excited");
  }
  if (const auto source = missing(); source != sources.end()) {
    return fail(
        ErrorCode::no_source,
        fmt::format(
            "source '{}' has not described itself; does its service run in the same DDS domain?",
            *source));
  }
  for (const auto& source : sources) {
    if (time_bases[source] != wire::TIME_BASE_UTC) {
      return fail(ErrorCode::no_source, no_time_scale(source));
    }
  }
  return {};
}

analysis::SyncPhasor phasor_of(const analysis::ChannelFit& fit) {
  return {fit.frequency.hz(),
          fit.u_frequency_hz,
          fit.phase_origin_ns,
          fit.fit.sine,
          fit.fit.cosine,
          std::sqrt(fit.fit.covariance[0]),
          std::sqrt(fit.fit.covariance[3])};
}

const analysis::ChannelFit* fit_of(const StepResult& result, const ChannelName& channel) {
  for (const analysis::ChannelFit& fit : result.fits) {
    if (fit.channel == channel.text()) {
      return &fit;
    }
  }
  return nullptr;
}

Expected<Measurements> measurements_of(const CalibrateAdcOptions& command, const BenchFile& bench,
                                       const RunOutcome& outcome) {
  Measurements measurements;
  for (const StepResult& result : outcome.results) {
    const analysis::ChannelFit* acs = fit_of(result, bench.method.sync_acs);
    const analysis::ChannelFit* dau = fit_of(result, bench.method.sync_dau);
    if (!result.valid || acs == nullptr || dau == nullptr) {
      continue;
    }
    const auto compared =
        analysis::compare_sync_adc(phasor_of(*acs), phasor_of(*dau), bench.excitation.duration_s,
                                   {.time_scale_s = command.u_time_scale_s,
                                    .acs_delay_s = bench.uncertainty.acs_delay_s,
                                    .acs_gain_rel = command.u_acs_gain_rel});
    if (!compared) {
      return fail(ErrorCode::no_result,
                  fmt::format("step {}, {} Hz: {}", result.step, result.frequency_text_hz,
                              compared.error().message));
    }
    measurements.push_back(compared->point);
    measurements.back().frequency_hz =
        result.frequency_hz; // what was asked for; the clocks see it a little off
  }
  return measurements;
}

// Gives all measurements of a pass the one test amplitude that they stand for.
Expected<void> name_amplitude(std::optional<double> asked_vpp, Measurements& measurements) {
  const auto [low, high] = std::minmax_element(
      measurements.begin(), measurements.end(),
      [](const auto& a, const auto& b) { return a.test_amplitude_vpp < b.test_amplitude_vpp; });
  const double lowest_vpp = low->test_amplitude_vpp;
  const double highest_vpp = high->test_amplitude_vpp;
  if (asked_vpp && (lowest_vpp < *asked_vpp * (1.0 - amplitude_tolerance) ||
                    highest_vpp > *asked_vpp * (1.0 + amplitude_tolerance))) {
    return fail(ErrorCode::no_result,
                fmt::format("sync has {:.4g} to {:.4g} V peak to peak at the ACS where the "
                            "generator was set to {:.4g} V: --amplitudes needs the generator's "
                            "output itself as sync",
                            lowest_vpp, highest_vpp, *asked_vpp));
  }
  if (!asked_vpp && highest_vpp > lowest_vpp * (1.0 + amplitude_spread)) {
    return fail(ErrorCode::no_result,
                fmt::format("sync ranges from {:.4g} to {:.4g} V peak to peak with the bench's "
                            "levels, but an ADC is calibrated at one amplitude after the other: "
                            "give --amplitudes",
                            lowest_vpp, highest_vpp));
  }
  const double step = std::pow(10.0, std::floor(std::log10(highest_vpp)) - 2.0);
  const double name_vpp =
      asked_vpp.value_or(std::round(0.5 * (lowest_vpp + highest_vpp) / step) * step);
  for (analysis::AdcCalibrationPoint& point : measurements) {
    point.test_amplitude_vpp = name_vpp;
  }
  return {};
}

Expected<Measurements> measure_pass(const CalibrateAdcOptions& command, const BenchFile& bench,
                                    const std::string& run, std::optional<double> amplitude_vpp,
                                    bus::Participant& participant, const std::stop_token& stop) {
  const BenchFile pass = bench_of_adc_pass(bench, amplitude_vpp);
  ProgressLine progress(stderr);
  RunController controller(participant, pass, run,
                           [&](const RunProgress& state) { progress.show(state); });
  auto outcome = controller.conduct({}, stop);
  progress.end();
  DYNCAL_TRY(outcome);
  DYNCAL_TRY(check_end(*outcome, "no file was written"));
  DYNCAL_TRY(auto measurements, measurements_of(command, pass, *outcome));
  if (measurements.size() < outcome->planned_steps) {
    return fail(
        ErrorCode::no_result,
        fmt::format(
            "{} of {} steps have no result; the analysis service reports why (dyncal watch)",
            outcome->planned_steps - measurements.size(), outcome->planned_steps));
  }
  DYNCAL_TRY(name_amplitude(amplitude_vpp, measurements));
  return measurements;
}

void print(const Measurements& measurements) {
  fmt::print("{:>10} {:>9} {:>11} {:>10} {:>12} {:>10} {:>11} {:>9}\n", "Hz", "V pp", "gain", "u",
             "lag in rad", "u", "delay in ns", "u");
  for (const analysis::AdcCalibrationPoint& point :
       analysis::adc_calibration_points(measurements)) {
    const double w = 2.0 * std::numbers::pi * point.frequency_hz;
    fmt::print("{:>10.4g} {:>9.4g} {:>11.7f} {:>10.1e} {:>12.3e} {:>10.1e} {:>11.1f} {:>9.1f}\n",
               point.frequency_hz, point.test_amplitude_vpp, point.gain, point.u_gain,
               point.phase_lag_rad, point.u_phase_lag_rad, 1e9 * point.phase_lag_rad / w,
               1e9 * point.u_phase_lag_rad / w);
    if (std::abs(point.phase_lag_rad) > w * max_adc_delay_s + 6.0 * point.u_phase_lag_rad) {
      fmt::print("{:>10} implausible for an ADC: do both sources mark the instant of "
                 "sampling in UTC? is a cable inverted?\n",
                 "");
    }
  }
}

Expected<void> write(const CalibrateAdcOptions& command, const BenchFile& bench,
                     const std::string& run, const Measurements& measurements) {
  const auto* unit = bench.source(bench.method.sync_dau.source)->as<SmartupSourceSettings>();
  AdcFileHead head;
  head.channel = command.channel;
  head.board = unit == nullptr ? 0 : unit->sensor & 0xffff0000U;
  head.date = fmt::format("{:%Y-%m-%d %H:%M:%S}",
                          fmt::gmtime(static_cast<std::time_t>(utc_now_ns() / 1'000'000'000)));
  head.remarks = {{"Bench", bench.bench},
                  {"Run", run},
                  {"Path", "data-ready"},
                  {"Reference", bench.method.sync_acs.text()},
                  {"TimeScale", fmt::format("UTC, u {:.3g} s", command.u_time_scale_s)}};
  return write_adc_file(command.output, head, measurements);
}

Expected<Measurements> measure(CalibrateAdcOptions& command, const BenchFile& bench,
                               const std::string& run, const std::stop_token& asked) {
  add_network_settings(bench.network, command.network);
  DYNCAL_TRY(const auto joined, WatchedNetwork::join(command.network, "dyncal-calibrate", asked));
  bus::Participant& participant = joined->participant;
  const std::stop_token stop = joined->stop();
  DYNCAL_TRY(require_common_time_scale(participant, bench, stop));
  std::vector<std::optional<double>> passes(command.amplitudes_vpp.begin(),
                                            command.amplitudes_vpp.end());
  if (passes.empty()) {
    passes.emplace_back();
  }
  Measurements all;
  for (std::size_t i = 0; i < passes.size(); ++i) {
    if (passes[i]) {
      fmt::print(stderr, "test amplitude {} V peak to peak, {} of {}\n", *passes[i], i + 1,
                 passes.size());
    }
    DYNCAL_TRY(const auto measured, measure_pass(command, bench, fmt::format("{}-{}", run, i + 1),
                                                 passes[i], participant, stop));
    all.insert(all.end(), measured.begin(), measured.end());
  }
  return all;
}

Expected<void> run_calibrate_adc(CalibrateAdcOptions& command, const std::stop_token& stop) {
  DYNCAL_TRY(const auto bench, read_bench_file(command.bench_file));
  DYNCAL_TRY(check_bench_for_adc(bench, !command.amplitudes_vpp.empty()));
  const std::string run = "adc-" + time_name(utc_now_ns());
  DYNCAL_TRY(const auto measurements, measure(command, bench, run, stop));
  print(measurements);
  DYNCAL_TRY(write(command, bench, run, measurements));
  fmt::print("wrote {}\nfor the bench file, under [corrections]:\nadc = {{ file = \"{}\", channel "
             "= \"{}\", phase_sign = \"lag\"{} }}\n",
             command.output.string(), command.output.filename().string(), command.channel,
             command.amplitudes_vpp.size() > 1
                 ? fmt::format(", test_amplitude_vpp = {}", command.amplitudes_vpp.front())
                 : "");
  return {};
}

const Command calibrate_command{260, "calibrate", "calibrate an instrument of the bench"};
const Command calibrate_adc_command{270, "calibrate adc",
                                    "response of a DAU's sync ADC over frequency and amplitude, "
                                    "against the ACS; both must stamp in "
                                    "UTC",
                                    add_adc, run_calibrate_adc};

} // namespace
} // namespace dyncal::inline programs
