// dyncal-virtual-bench: a calibration bench without hardware, for demonstrations and tests.
#include <csignal>
#include <cstdlib>
#include <fmt/core.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sys/prctl.h>
#include <unistd.h>

#include "drivers/virtual_bench/truth.hpp"
#include "services/virtual_bench/bench_options.hpp"

namespace {

namespace device = dyncal::drivers::virtual_bench;
using dyncal::services::Error;
using dyncal::services::ErrorCode;
using dyncal::services::Expected;
using dyncal::services::virtual_bench::BenchOptions;

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

// Whole or not at all: a reader that polls for the file never sees half of it.
Expected<void> write_file(const std::filesystem::path& path, const std::string& text) {
  if (path.empty()) {
    return {};
  }
  const std::filesystem::path unfinished = path.string() + ".part";
  std::ofstream(unfinished, std::ios::binary) << text << std::flush;
  std::error_code problem;
  std::filesystem::rename(unfinished, path, problem);
  if (problem) {
    return tl::unexpected(Error{ErrorCode::bad_file, fmt::format("{}: cannot be written ({})", path.string(), problem.message())});
  }
  return {};
}

Expected<void> record(device::VirtualBench& bench, const BenchOptions& options) {
  std::error_code problem;
  std::filesystem::create_directories(options.record_folder, problem);
  return device::record_csv(bench, options.programme, options.record_folder).map_error([](const dyncal::drivers::Error& error) {
    return Error{ErrorCode::bad_file, error.message};
  });
}

Expected<void> serve(device::VirtualBench& bench, const BenchOptions& options) {
  device::ServerSettings settings = options.server;
  if (settings.triggered) {
    settings.triggered->sensor = device::series_sensor_of(options.bench.preset, options.bench.seed, bench.unit().range_m_s2());
    settings.triggered->sensor.free_running = options.free_running_sensor;
  }
  device::BenchServer server(bench, settings);
  if (auto opened = server.open(); !opened) {
    return tl::unexpected(Error{ErrorCode::device, opened.error().message});
  }
  nlohmann::json ports = {{"acs", server.acs_port()}, {"generator", server.generator_port()}, {"process_id", getpid()}};
  if (server.triggered()) {
    ports["dso"] = server.triggered()->scope_port();
    ports["tss"] = server.triggered()->sensor_port();
  }
  if (auto written = write_file(options.ports_file, ports.dump() + "\n"); !written) {
    return written;
  }
  fmt::print(stderr, "dyncal-virtual-bench: {}, ports {}, datagrams to {}\n", options.bench.preset.name, ports.dump(),
             options.server.dau.text());
  server.run(stop_signal());
  return {};
}

Expected<void> run(const BenchOptions& options) {
  if (options.exit_with_parent) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
  }
  device::VirtualBench bench(options.bench);
  if (auto written = write_file(options.truth_file, device::truth_json(bench, options.programme.frequencies_hz)); !written) {
    return written;
  }
  if (auto written = write_file(options.adc_file, device::adc_calibration_json(bench, options.programme.frequencies_hz)); !written) {
    return written;
  }
  return options.record_folder.empty() ? serve(bench, options) : record(bench, options);
}

} // namespace

int main(int argc, char** argv) {
  stop_on_signals();
  const auto options = dyncal::services::virtual_bench::parse_command_line(argc, argv);
  if (options && !options->has_value()) {
    return EXIT_SUCCESS;
  }
  const Expected<void> done = options ? run(**options) : tl::unexpected(options.error());
  if (!done) {
    fmt::print(stderr, "dyncal-virtual-bench: {}\n", done.error().message);
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
