#include "services/programs/virtual_bench/bench_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/base/parsed_number.hpp"
#include "services/base/version.hpp"
#include "services/daemon/program/command_line.hpp"
#include "services/daemon/program/options.hpp"
#include "services/programs/virtual_bench/excitation_option.hpp"
#include "services/programs/virtual_bench/fault_option.hpp"

namespace dyncal::inline programs::virtual_bench {
namespace {

namespace device = dyncal::drivers::virtual_bench;

// The words of the command line as they come, before they are checked against each other.
struct Words {
  std::string preset = "mpu9250-paper";
  std::string speed = "1";
  std::string dau = "127.0.0.1:7654";
  std::string acs = "127.0.0.1:0";
  std::string generator = "127.0.0.1:0";
  std::string dso = "127.0.0.1:0";
  std::string tss = "127.0.0.1:0";
  std::string sensor = "0xbccb0100";
  std::string can_bus = "1M";
  std::string generator_words = "dg4000";
  std::vector<std::string> scope_faults;
  std::size_t scope_pieces = 0;
  std::string response;
  std::optional<std::int64_t> acs_rate_hz;
  std::optional<double> interferometer_nm;
  device::InterferometerSettings interferometer;
  std::vector<std::string> faults;
  ExcitationWords excitation;
};

template <class... Parts>
tl::unexpected<Error> refuse(fmt::format_string<Parts...> format, Parts&&... parts) {
  return fail(ErrorCode::bad_argument, fmt::format(format, std::forward<Parts>(parts)...));
}

void add_instrument_options(CLI::App& app, Words& words, BenchOptions& options) {
  add_default(app, "--preset", words.preset,
              fmt::format("sensor: {}", fmt::join(device::preset_names(), ", ")));
  add_default(app, "--seed", options.bench.seed, "everything drawn follows from it");
  add_default(app, "--speed", words.speed, "times real time, or max");
  app.add_option("--duration", options.server.duration_s,
                 "end after so many seconds of bench time (0: never)");
  add_default(app, "--dau", words.dau, "HOST:PORT that the unit sends its datagrams to");
  add_default(app, "--acs-listen", words.acs, "HOST:PORT of the ACS stream (port 0: chosen)");
  add_default(app, "--generator-listen", words.generator,
              "HOST:PORT of the generator's SCPI (port 0: chosen)");
  add_default(app, "--generator-words", words.generator_words,
              "whose SCPI the generator speaks: dg4000, 33500", CLI::IsMember({"dg4000", "33500"}));
  add_default(app, "--dso-listen", words.dso, "HOST:PORT of the oscilloscope's SCPI (preset tss)");
  add_default(app, "--tss-listen", words.tss, "HOST:PORT of the time series sensor (preset tss)");
  app.add_flag("--tss-free-running", options.bench.faults.series_start.free_running,
               "the same as --fault free-running");
  app.add_option("--scope-fault", words.scope_faults,
                 fmt::format("NAME=PROBABILITY per answer of the oscilloscope: {}",
                             fmt::join(device::scope_fault_names(), ", ")));
  app.add_option("--scope-pieces", words.scope_pieces,
                 "the oscilloscope's answers come in pieces of so many bytes (0: whole)");
  app.add_option("--ports-file", options.ports_file,
                 "write the ports to this file as JSON once they are open");
  app.add_option("--truth", options.truth_file, "write what is true to this file");
  app.add_option("--acs-table", options.acs_table,
                 "the ACS evaluates each excitation itself, and writes this table");
  app.add_option("--adc-file", options.adc_file,
                 "write the calibration of the sync ADC to this file");
}

void add_can_options(CLI::App& app, Words& words, BenchOptions& options) {
  app.add_option("--can", options.can_interface,
                 "put a sensor with CAN output on this interface; all instruments then keep the "
                 "UTC of this host, in real time");
  add_default(app, "--can-bus", words.can_bus,
              "500k, 1M (classic CAN) or fd-5M (CAN FD, 1 and 5 Mbit/s)");
  add_checked(app, "--can-load", options.can.background_load,
              "share of the bus's time that other devices take", CLI::Range(0.0, 0.8));
  app.add_option("--dbc-file", options.dbc_file,
                 "write the DBC file of the sensor with CAN output to this file");
}

void add_model_options(CLI::App& app, Words& words, BenchOptions& options) {
  app.add_option("--response", words.response,
                 "CSV file with the response of the sensor's z axis, in place of the preset's: "
                 "frequency_hz,magnitude,phase_rad (magnitude of m/s^2 over m/s^2; lead)");
  app.add_option("--frequencies", words.excitation.frequencies,
                 "in Hz, decimal text, comma separated")
      ->delimiter(',');
  app.add_option("--levels", words.excitation.levels,
                 "in m/s^2, one or one per frequency; the highest decides the ranges")
      ->delimiter(',');
  add_checked(app, "--acs-rate", words.acs_rate_hz,
              "samples per second (20000; of an interferometer 500000)", CLI::Range(100, 1000000));
  app.add_flag("--acs-utc", options.bench.acs_utc, "the ACS stamps in UTC, as the unit does");
  app.add_flag("--acs-pulses", options.bench.acs_pulses,
               "the ACS has a third channel, 'pps': the pulses of a GPS receiver; the unit then "
               "keeps the UTC of this host, in real time");
  app.add_flag(
      "--sync-is-first-output", options.bench.sync_is_first_output,
      "sync is the output that drives the exciter, not a second one of constant amplitude");
  add_default(app, "--exciter-gain", options.bench.faults.exciter_gain,
              "the same as --fault exciter-gain=FACTOR", CLI::PositiveNumber);
  add_checked(app, "--thermal-cycle", options.bench.thermal_cycle_s,
              "seconds for the sensor's warm-up", CLI::PositiveNumber);
  add_checked(app, "--reference-magnitude-rel", options.bench.reference_magnitude_rel,
              "standard uncertainty, relative", CLI::Range(0.0, 1.0));
  add_checked(app, "--reference-phase-rad", options.bench.reference_phase_rad,
              "standard uncertainty in rad", CLI::Range(0.0, 1.0));
  add_default(app, "--sensor", words.sensor, "id of the sensor in the unit");
}

void add_interferometer_options(CLI::App& app, Words& words) {
  add_checked(app, "--interferometer", words.interferometer_nm,
              "the ACS records the two signals of a laser interferometer instead of a reference; "
              "wavelength in air, in nm",
              CLI::Range(200.0, 20000.0));
  add_default(app, "--wavelength-u-rel", words.interferometer.u_wavelength_rel,
              "of the interferometer: standard uncertainty of the wavelength, relative",
              CLI::Range(0.0, 1e-2));
  add_default(app, "--detector-bandwidth", words.interferometer.detector_bandwidth_hz,
              "of the interferometer, in Hz", CLI::PositiveNumber);
  add_default(app, "--skew-u", words.interferometer.u_skew_s,
              "of the interferometer: standard uncertainty of the delay of u2 after u1, in s",
              CLI::Range(0.0, 1e-6));
}

void add_path_options(CLI::App& app, Words& words, BenchOptions& options) {
  app.add_flag("--ticks", options.server.with_ticks, "send time_ticks, as units do since 2021-07");
  add_checked(app, "--loss", options.server.path.loss, "probability that a datagram is lost",
              CLI::Range(0.0, 1.0));
  add_checked(app, "--duplicate", options.server.path.duplicate,
              "probability that a datagram comes twice", CLI::Range(0.0, 1.0));
  add_checked(app, "--reorder", options.server.path.reorder,
              "probability that a datagram comes after the next one", CLI::Range(0.0, 1.0));
  app.add_option("--fault", words.faults, fault_help());
  add_default(app, "--datagrams-per-second", options.server.datagrams_per_s,
              "most datagrams in a second of this host", CLI::PositiveNumber);
}

void add_recording_options(CLI::App& app, Words& words, BenchOptions& options) {
  app.add_option("--record-csv", options.record_folder,
                 "write acs.csv and dau.csv into this folder instead of opening sockets");
  add_checked(app, "--repetitions", options.programme.repetitions, "with --record-csv",
              CLI::PositiveNumber);
  add_checked(app, "--settling", options.programme.settling_s, "with --record-csv, seconds",
              CLI::NonNegativeNumber);
  add_checked(app, "--duration-per-step", options.programme.duration_s,
              "with --record-csv, seconds", CLI::PositiveNumber);
  app.add_option("--multisine", words.excitation.multisine_period_s,
                 "all frequencies at once, as lines of a waveform of so many seconds: what "
                 "--record-csv excites, and what the ranges are for")
      ->check(CLI::PositiveNumber);
  app.add_flag("--exit-with-parent", options.exit_with_parent,
               "end when the process that started this one ends");
}

void add_options(CLI::App& app, Words& words, BenchOptions& options) {
  add_instrument_options(app, words, options);
  add_can_options(app, words, options);
  add_model_options(app, words, options);
  add_interferometer_options(app, words);
  add_path_options(app, words, options);
  add_recording_options(app, words, options);
}

Expected<void> read_addresses(const Words& words, device::ServerSettings& server) {
  const std::pair<const std::string*, drivers::Address*> addresses[] = {
      {&words.dau, &server.dau},
      {&words.acs, &server.acs_listen},
      {&words.generator, &server.generator_listen}};
  for (const auto& [text, address] : addresses) {
    auto parsed = drivers::parse_address(*text);
    if (!parsed) {
      return refuse("{}", parsed.error().message);
    }
    *address = *parsed;
  }
  return {};
}

Expected<void> read_scope_faults(const std::vector<std::string>& texts,
                                 device::ScopeFaults& faults) {
  constexpr const char* option = "--scope-fault";
  const std::vector<std::string>& known = device::scope_fault_names();
  for (const std::string& text : texts) {
    const std::size_t sign = text.find('=');
    const std::string name = text.substr(0, sign);
    if (std::ranges::find(known, name) == known.end()) {
      return refuse("{} {}: no such fault; there are: {}", option, text, fmt::join(known, ", "));
    }
    const auto probability =
        sign == std::string::npos ? std::nullopt : parsed_number<double>(text.substr(sign + 1));
    if (!probability || !(*probability >= 0.0 && *probability <= 1.0)) {
      return refuse("{} {}: write NAME=PROBABILITY with a probability from 0 to 1", option, text);
    }
    faults[name] = *probability;
  }
  return {};
}

Expected<void> read_programme(const Words& words, BenchOptions& options) {
  DYNCAL_TRY(options.bench.highest_level_m_s2,
             read_excitation(words.excitation, options.programme));
  return {};
}

Expected<void> read_can(const Words& words, BenchOptions& options) {
  const auto& kinds = device::can_bus_kinds();
  const auto kind = std::ranges::find(kinds, words.can_bus, &device::CanBusKind::name);
  if (kind == kinds.end()) {
    return refuse("--can-bus {}: no such bus; there are 500k, 1M, fd-5M", words.can_bus);
  }
  options.can.bus = *kind;
  options.can.preset = options.bench.preset;
  options.can.seed = options.bench.seed;
  options.can.highest_level_m_s2 = options.bench.highest_level_m_s2;
  options.can.faults = options.bench.faults.sensor;
  options.can.loss = options.bench.faults.sensor_loss;
  if (options.bench.response) {
    options.can.preset.axes[2] = options.bench.response->response;
    options.can.latency_s = std::min(options.can.latency_s, options.can.preset.axes[2].delay_s);
  }
  if (!options.can_interface.empty() && options.bench.preset.triggered) {
    return refuse("--can: the sensor of preset tss records series and has no CAN output; choose "
                  "another preset");
  }
  return {};
}

// After everything else: the sensor's range follows from the levels.
Expected<void> read_triggered(const Words& words, BenchOptions& options) {
  if (!options.bench.preset.triggered) {
    return {};
  }
  device::TriggeredSettings triggered;
  triggered.trigger.seed = options.bench.seed;
  triggered.trigger.sync_amplitude_v = device::VirtualBench::sync_amplitude_v;
  triggered.piece_bytes = words.scope_pieces;
  const auto scope = drivers::parse_address(words.dso);
  const auto sensor = drivers::parse_address(words.tss);
  if (!scope || !sensor) {
    return refuse("{}", (scope ? sensor : scope).error().message);
  }
  triggered.scope_listen = *scope;
  triggered.sensor_listen = *sensor;
  options.server.triggered = triggered;
  if (options.bench.faults.sensor_loss.probability > 0.0 &&
      options.bench.faults.sensor_loss.counted) {
    return refuse("--fault loss: the samples of a series have no numbers; write counted=no");
  }
  return read_scope_faults(words.scope_faults, options.server.triggered->faults);
}

Expected<void> read_bench_faults(const Words& words, device::BenchFaults& faults) {
  for (const std::string& text : words.faults) {
    DYNCAL_TRY(read_fault(text, faults));
  }
  return {};
}

Expected<void> read_response(const Words& words, BenchOptions& options) {
  if (words.response.empty()) {
    return {};
  }
  auto table = device::read_response_file(words.response);
  if (!table) {
    return fail(ErrorCode::bad_file, table.error().message);
  }
  for (const std::string& text : options.programme.frequencies_hz) {
    const auto frequency_hz = parsed_number<double>(text);
    if (frequency_hz && !table->covers(*frequency_hz)) {
      return refuse("--frequencies: {} Hz lies outside the response of {}, which is "
                    "known from {} to {} Hz",
                    text, words.response, table->first_hz, table->last_hz);
    }
  }
  options.bench.response = std::move(*table);
  return {};
}

// After the faults.
Expected<void> read_acs(const Words& words, device::BenchSettings& bench) {
  constexpr std::int64_t lowest_rate_hz = 100'000; // its motion is followed in blocks of samples
  if (!words.interferometer_nm) {
    bench.acs_rate_hz = words.acs_rate_hz.value_or(bench.acs_rate_hz);
    return {};
  }
  bench.acs_rate_hz = words.acs_rate_hz.value_or(500'000);
  if (bench.acs_rate_hz < lowest_rate_hz) {
    return refuse("--acs-rate {}: an interferometer needs at least {} samples per second",
                  bench.acs_rate_hz, lowest_rate_hz);
  }
  if (bench.acs_pulses) {
    return refuse("--acs-pulses: an interferometer records no pulses");
  }
  if (bench.faults.reference != device::ChannelFaults{} ||
      bench.faults.sync_acs != device::ChannelFaults{}) {
    return refuse("--fault: the channels of an interferometer have no faults at reference or "
                  "sync_acs");
  }
  bench.interferometer = words.interferometer;
  bench.interferometer->wavelength_m = *words.interferometer_nm * 1e-9;
  return {};
}

Expected<void> check_acs_table(const BenchOptions& options) {
  if (options.acs_table.empty()) {
    return {};
  }
  if (!options.record_folder.empty()) {
    return refuse("--acs-table is not for --record-csv, whose samples 'dyncal analyse' evaluates");
  }
  if (options.bench.interferometer) {
    return refuse("--acs-table: no table is made of the signals of an interferometer");
  }
  return {};
}

Expected<void> read_words(const Words& words, BenchOptions& options) {
  const auto preset = device::preset_by_name(words.preset);
  if (!preset) {
    return refuse("--preset {}: no such sensor; there are: {}", words.preset,
                  fmt::join(device::preset_names(), ", "));
  }
  options.bench.preset = *preset;
  options.bench.generator_words = words.generator_words == "33500"
                                      ? device::GeneratorWords::keysight_33500
                                      : device::GeneratorWords::dg4000;
  options.server.speed =
      words.speed == "max" ? 0.0 : parsed_number<double>(words.speed).value_or(-1.0);
  if (words.speed != "max" && !(options.server.speed > 0.0)) {
    return refuse("--speed {}: write a number above 0, or max", words.speed);
  }
  const bool hexadecimal = words.sensor.starts_with("0x");
  const auto sensor = parsed_number<std::uint32_t>(
      hexadecimal ? words.sensor.substr(2) : words.sensor, hexadecimal ? 16 : 10);
  if (!sensor) {
    return refuse("--sensor {}: write a number such as 0xbccb0100", words.sensor);
  }
  options.server.sensor_id = *sensor;
  return read_addresses(words, options.server)
      .and_then([&] { return read_bench_faults(words, options.bench.faults); })
      .and_then([&] { return read_acs(words, options.bench); })
      .and_then([&] { return read_programme(words, options); })
      .and_then([&] { return read_response(words, options); })
      .and_then([&] { return read_triggered(words, options); })
      .and_then([&] { return read_can(words, options); })
      .and_then([&] { return check_acs_table(options); });
}

} // namespace

Expected<std::optional<BenchOptions>> parse_command_line(int argc, char** argv) {
  CLI::App app{"A calibration bench without hardware: generator, exciter, analogue calibration "
               "system and SmartUp Unit, reached through "
               "their real protocols.",
               "dyncal-virtual-bench"};
  app.set_version_flag("--version", build_description());
  Words words;
  BenchOptions options;
  add_options(app, words, options);
  DYNCAL_TRY(const auto parsed, dyncal::parse_command_line(app, argc, argv));
  if (!parsed) {
    return std::nullopt;
  }
  DYNCAL_TRY(read_words(words, options));
  return options;
}

} // namespace dyncal::inline programs::virtual_bench
