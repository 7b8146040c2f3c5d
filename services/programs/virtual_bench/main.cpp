// dyncal-virtual-bench: a calibration bench without hardware, for demonstrations and tests.
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fmt/core.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <sys/prctl.h>
#include <unistd.h>

#include "drivers/utc_clock.hpp"
#include "drivers/virtual_bench/can/can_line.hpp"
#include "drivers/virtual_bench/can/can_sensor.hpp"
#include "drivers/virtual_bench/model/truth.hpp"
#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"
#include "services/daemon/program/command_line.hpp"
#include "services/programs/virtual_bench/bench_options.hpp"
#include "services/programs/virtual_bench/evaluating_acs.hpp"

namespace {

namespace device = dyncal::drivers::virtual_bench;
using dyncal::fail;
using dyncal::base::Error;
using dyncal::base::ErrorCode;
using dyncal::base::Expected;
using dyncal::base::json_text;
using dyncal::virtual_bench::BenchOptions;

dyncal::drivers::StopSignal& stop_signal() {
  static dyncal::drivers::StopSignal signal;
  return signal;
}

void on_signal(int) {
  stop_signal().raise();
} // one write() to a descriptor: allowed in a signal handler

void stop_on_signals() {
  stop_signal();
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

Expected<void> write_if_named(const std::filesystem::path& path, const std::string& text) {
  return path.empty() ? Expected<void>{} : dyncal::base::write_output_file(path, text);
}

Expected<void> record(device::VirtualBench& bench, const BenchOptions& options) {
  std::error_code problem;
  std::filesystem::create_directories(options.record_folder, problem);
  return device::record_csv(bench, options.programme, options.record_folder)
      .map_error([](const dyncal::drivers::Error& error) {
        return Error{ErrorCode::bad_file, error.message};
      });
}

// The sensor with CAN output and its line, which lives in UTC.
struct CanPart {
  CanPart(const BenchOptions& options, dyncal::drivers::can::FrameSender sender)
      : origin_ns(*options.bench.utc_origin_ns), sensor(options.can), line(std::move(sender)) {}

  void advance_to(double time_s, const device::VirtualBench& bench) {
    sensor.advance_to(
        time_s, bench.excitation(), [this](const dyncal::drivers::virtual_bench::SentFrame& sent) {
          const bool exact = sent.frame.id == dyncal::drivers::virtual_bench::CanSensor::id;
          line.put(sent.frame, origin_ns + std::llround(sent.end_s * 1e9), exact);
        });
  }

  std::int64_t origin_ns;
  dyncal::drivers::virtual_bench::CanSensor sensor;
  dyncal::drivers::virtual_bench::CanLine line;
};

// Nothing when the bench has no sensor with CAN output.
Expected<std::unique_ptr<CanPart>> open_can(const BenchOptions& options) {
  if (options.can_interface.empty()) {
    return nullptr;
  }
  auto sender = dyncal::drivers::can::FrameSender::open(options.can_interface);
  if (!sender) {
    return fail(ErrorCode::device, sender.error().message);
  }
  auto part = std::make_unique<CanPart>(options, std::move(*sender));
  DYNCAL_TRY(write_if_named(options.dbc_file, part->sensor.dbc()));
  return part;
}

device::SeriesSensorSettings series_sensor_of(const device::VirtualBench& bench) {
  const device::BenchSettings& settings = bench.settings();
  auto sensor = device::series_sensor_of(settings.preset, settings.seed, bench.unit().range_m_s2());
  sensor.highest_level_m_s2 = settings.highest_level_m_s2;
  sensor.start = settings.faults.series_start;
  sensor.faults = settings.faults.sensor;
  sensor.loss = settings.faults.sensor_loss.probability;
  return sensor;
}

Expected<void> serve(device::VirtualBench& bench, const BenchOptions& options) {
  device::ServerSettings settings = options.server;
  if (settings.triggered) {
    settings.triggered->sensor = series_sensor_of(bench);
  }
  DYNCAL_TRY(auto can, open_can(options));
  if (can) {
    dyncal::drivers::virtual_bench::request_realtime_priority(5); // below the line
    settings.after_advance = [&](double time_s) { can->advance_to(time_s, bench); };
  }
  std::optional<dyncal::virtual_bench::EvaluatingAcs> acs;
  if (!options.acs_table.empty()) {
    DYNCAL_TRY(auto opened,
               dyncal::virtual_bench::EvaluatingAcs::open(bench.acs(), options.acs_table));
    acs.emplace(std::move(opened));
    settings.with_samples = [&](const device::AcsSamples& samples) {
      acs->take(samples, bench.drive());
    };
  }
  device::BenchServer server(bench, settings);
  if (auto opened = server.open(); !opened) {
    return fail(ErrorCode::device, opened.error().message);
  }
  nlohmann::json ports = {
      {"acs", server.acs_port()}, {"generator", server.generator_port()}, {"process_id", getpid()}};
  if (server.triggered()) {
    ports["dso"] = server.triggered()->scope_port();
    ports["tss"] = server.triggered()->sensor_port();
  }
  DYNCAL_TRY(write_if_named(options.ports_file, json_text(ports) + "\n"));
  fmt::print(stderr, "dyncal-virtual-bench: {}, ports {}, datagrams to {}\n",
             options.bench.preset.name, json_text(ports), options.server.dau.text());
  server.run(stop_signal());
  if (can) {
    const auto& line = can->line;
    fmt::print(
        stderr,
        "dyncal-virtual-bench: {} frames on {}, {} of the {} of the sensor late, {} refused\n",
        line.sent(), options.can_interface, line.late(), line.exact(), line.refused());
  }
  return {};
}

Expected<void> run(BenchOptions options) {
  if (options.exit_with_parent) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
  }
  const bool is_live = options.record_folder.empty();
  if (!options.can_interface.empty() || (options.bench.acs_pulses && is_live)) {
    options.bench.utc_origin_ns = dyncal::utc_now_ns();
  }
  device::VirtualBench bench(options.bench);
  DYNCAL_TRY(write_if_named(options.truth_file,
                            device::truth_json(bench, options.programme.frequencies_hz)));
  DYNCAL_TRY(write_if_named(options.adc_file,
                            device::adc_calibration_json(bench, options.programme.frequencies_hz)));
  return is_live ? serve(bench, options) : record(bench, options);
}

} // namespace

int main(int argc, char** argv) {
  stop_on_signals();
  const auto options = dyncal::virtual_bench::parse_command_line(argc, argv);
  if (options && !options->has_value()) {
    return EXIT_SUCCESS;
  }
  const Expected<void> done = options ? run(**options) : fail(options.error());
  if (!done) {
    fmt::print(stderr, "dyncal-virtual-bench: {}\n", done.error().message);
    return options ? EXIT_FAILURE : dyncal::daemon::wrong_command_line;
  }
  return EXIT_SUCCESS;
}
