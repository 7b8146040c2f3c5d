// `dyncal demo`: a whole virtual bench, its services, DDS, analysis and report on this machine.
//
// Every instrument and service is a process of its own and talks as it does in a laboratory. All
// files go to one folder: bench file, ADC calibration, logs, result, figures, and the truth, which
// only the final comparison reads. With a response from a file the demo leaves out the frequencies
// at which the file does not know it. Belongs to one thread; all processes have ended when it
// returns.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "drivers/link/file_descriptor.hpp"
#include "drivers/virtual_bench/model/response_file.hpp"
#include "services/base/output_file.hpp"
#include "services/daemon/program/child_process.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/kept_run.hpp"
#include "services/programs/command/run_command.hpp"
#include "services/programs/demo/demo_bench.hpp"
#include "services/programs/demo/truth_check.hpp"
#include "services/programs/demo/vendor_assignment.hpp"
#include "services/views/report/show_outcome.hpp"

namespace dyncal::inline programs {
namespace {

struct DemoOptions {
  std::string preset = "mpu9250-paper";
  std::string dds;         // empty: the first of the build, for all
  std::string speed = "8"; // times real time, or "max"
  std::uint64_t seed = 1;
  std::optional<int> domain; // chosen by itself
  std::filesystem::path folder = "demo";
  KeepOptions keep; // no run folder unless it names one
  std::optional<int> repetitions;
  std::optional<double> duration_s;
  bool trigger_phase_correction = true; // series time stamping
  double loss = 0.0;                    // of datagrams, 0..1
  double duplicates = 0.0;
  std::string can_interface = "vcan0"; // presets with CAN output
  std::string can_bus = "1M";
  std::optional<std::filesystem::path> response; // of the sensor, in place of the preset's
  std::vector<std::string> faults;               // of the virtual bench, each as its --fault
};

void add_demo(CLI::App& command, DemoOptions& demo) {
  std::vector<std::string> presets;
  for (const DemoPreset& preset : demo_presets()) {
    presets.push_back(preset.name);
  }
  add_default(command, "--preset", demo.preset, "the bench that is played", CLI::IsMember(presets));
  command.add_option("--dds", demo.dds,
                     "fastdds, cyclonedds, or one for each: "
                     "dau=cyclonedds,acs=fastdds,analysis=cyclonedds,run=fastdds");
  command.add_flag("--trigger-correction,!--no-trigger-correction", demo.trigger_phase_correction,
                   "preset tss: correct every shot for the phase of sync at the trigger "
                   "(default); without it you see what the correction is worth");
  add_default(command, "--speed", demo.speed, "multiple of real time, or max");
  add_default(command, "--seed", demo.seed, "seed of the virtual bench's random numbers");
  command
      .add_option("--domain", demo.domain, "DDS domain (default: one that other demos do not use)")
      ->envname("DYNCAL_DOMAIN")
      ->check(CLI::Range(0, 232));
  add_default(command, "--output", demo.folder, "folder of all files");
  command.add_option("--folder", demo.keep.folder,
                     "keep the run below this folder as 'dyncal run' does (default: not)");
  command.add_option("--store", demo.keep.store, "store for that run, as in 'dyncal run'");
  add_checked(command, "--repetitions", demo.repetitions, "repetitions of the excitation list",
              CLI::Range(1, 1000));
  add_checked(command, "--duration", demo.duration_s,
              "duration of the evaluated part of a step, in seconds of the bench",
              CLI::PositiveNumber);
  add_checked(command, "--loss", demo.loss,
              "fraction of the unit's datagrams that are lost, 0 to 1", CLI::Range(0.0, 1.0));
  add_checked(command, "--duplicate", demo.duplicates,
              "fraction of the unit's datagrams that arrive twice, 0 to 1", CLI::Range(0.0, 1.0));
  command.add_option("--response", demo.response,
                     "put a sensor with this response on the bench: CSV file, "
                     "frequency_hz,magnitude,phase_rad");
  command.add_option("--fault", demo.faults,
                     "what is wrong on purpose, again for each fault, as "
                     "'dyncal-virtual-bench --help' lists it: hum=0.01,at=sensor");
  add_default(
      command, "--can", demo.can_interface,
      "interface for presets can and can-sync; 'ip link add vcan0 type vcan' makes a virtual one");
  add_default(command, "--can-bus", demo.can_bus,
              "500k, 1M (classic CAN) or fd-5M (CAN FD, 1 and 5 Mbit/s)",
              CLI::IsMember({"500k", "1M", "fd-5M"}));
}

using namespace std::chrono_literals;

constexpr double agreement_limit = 5.0; // standard uncertainties; of hundreds, 4 come by chance
constexpr auto start_limit = 10s;
// Domains whose ports lie below those that Linux hands out to clients; chosen by process so that
// two demos do not meet.
constexpr int first_demo_domain = 20;
constexpr int demo_domains = 80;

// Of the reference: the bench draws its errors from them and the recipe states them. With the
// interferometer on the bench it is for the motion of its spot beside the sensor.
DemoUncertainty uncertainty_of(const DemoPreset& preset) {
  const double of_reference = preset.laser ? 1e-4 : 5e-4;
  return {.reference_magnitude_rel = of_reference,
          .reference_phase_rad = of_reference,
          .acs_rate_rel = 3e-7};
}

struct Demo {
  DemoPreset preset;
  std::map<std::string, std::string> dds;
  int domain = 0;
  std::string bench;
  std::filesystem::path folder;
  std::vector<ChildProcess> processes;
};

bool is_free_udp_port(std::uint16_t port) {
  const drivers::FileDescriptor probe(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  void* raw = &address;
  return probe.is_open() && bind(probe.number(), static_cast<sockaddr*>(raw), sizeof address) == 0;
}

// The unit sends to it, so it must be known before the receiver opens it. Linux does not give ports
// from 61000 on to clients, such as the DDS programs that start meanwhile.
Expected<std::uint16_t> free_udp_port() {
  constexpr int first = 61'000;
  constexpr int ports = 65'536 - first;
  for (int i = 0; i < ports; ++i) {
    const auto port = static_cast<std::uint16_t>(first + (getpid() + i) % ports);
    if (is_free_udp_port(port)) {
      return port;
    }
  }
  return fail(ErrorCode::network, "this machine has no free UDP port on 127.0.0.1");
}

// Excites where the response is known.
Expected<void> follow_response(const std::filesystem::path& file, DemoPreset& preset) {
  const auto table = drivers::virtual_bench::read_response_file(file);
  if (!table) {
    return fail(ErrorCode::bad_file, table.error().message);
  }
  const auto left_out = keep_frequencies(preset, table->first_hz, table->last_hz);
  if (preset.frequencies_hz.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the response is known from {} to {} Hz, where preset {} excites "
                            "nothing; choose another preset",
                            file.string(), table->first_hz, table->last_hz, preset.name));
  }
  if (!left_out.empty()) {
    fmt::print("Without {} Hz, where {} states no response\n", fmt::join(left_out, ", "),
               file.string());
  }
  return {};
}

Expected<Demo> prepare(const DemoOptions& command) {
  Demo demo;
  demo.preset = *std::ranges::find(demo_presets(), command.preset, &DemoPreset::name);
  demo.preset.repetitions = command.repetitions.value_or(demo.preset.repetitions);
  demo.preset.duration_s = command.duration_s.value_or(demo.preset.duration_s);
  demo.preset.trigger_phase_correction = command.trigger_phase_correction;
  if (command.response) {
    DYNCAL_TRY(follow_response(*command.response, demo.preset));
  }
  DYNCAL_TRY(demo.dds, parse_vendor_assignment(command.dds));
  demo.domain =
      command.domain.value_or(first_demo_domain + static_cast<int>(getpid() % demo_domains));
  demo.bench = fmt::format("demo-{}", getpid());
  demo.folder = std::filesystem::absolute(command.folder);
  DYNCAL_TRY(check_output_folder(demo.folder));
  return demo;
}

Expected<void> start(Demo& demo, const std::string& program,
                     const std::vector<std::string>& arguments) {
  const std::filesystem::path log = demo.folder / (program + ".log");
  DYNCAL_TRY(auto process, ChildProcess::start(program_folder() / program, arguments, {log, log}));
  demo.processes.push_back(std::move(process));
  return {};
}

// Waits until the process has written a JSON file.
Expected<nlohmann::json> wait_for_json(const std::filesystem::path& path, ChildProcess& process) {
  const auto deadline = std::chrono::steady_clock::now() + start_limit;
  while (std::chrono::steady_clock::now() < deadline && process.running()) {
    std::ifstream stream(path);
    nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
    if (!json.is_discarded()) {
      return json;
    }
    std::this_thread::sleep_for(20ms); // until the file is there or the deadline is over
  }
  return fail(ErrorCode::device,
              fmt::format("{} did not start: {}", process.name(), process.last_line()));
}

// About how long the run takes in the bench's own time, in which the sensor is to warm up.
double bench_seconds(const DemoPreset& preset) {
  constexpr double between_steps_s = 1.0;
  return static_cast<double>(preset.frequencies_hz.size()) * preset.repetitions *
         (preset.settling_s + preset.duration_s + between_steps_s);
}

std::vector<std::string> bench_arguments(const DemoOptions& command, const Demo& demo,
                                         std::uint16_t dau_port) {
  const DemoPreset& preset = demo.preset;
  const DemoUncertainty uncertainty = uncertainty_of(preset);
  std::vector<std::pair<std::string, std::string>> options{
      {"--preset", preset.sensor()},
      {"--seed", std::to_string(command.seed)},
      {"--speed", command.speed},
      {"--dau", fmt::format("127.0.0.1:{}", dau_port)},
      {"--acs-listen", "127.0.0.1:0"},
      {"--generator-listen", "127.0.0.1:0"},
      {"--truth", demo.folder / "truth.json"},
      {"--adc-file", demo.folder / "adc.json"},
      {"--ports-file", demo.folder / "ports.json"},
      {"--frequencies", fmt::format("{}", fmt::join(preset.frequencies_hz, ","))},
      {"--levels", fmt::format("{}", fmt::join(preset.levels_m_s2, ","))},
      {"--reference-magnitude-rel", fmt::format("{}", uncertainty.reference_magnitude_rel)},
      {"--reference-phase-rad", fmt::format("{}", uncertainty.reference_phase_rad)},
      {"--thermal-cycle", fmt::format("{:.0f}", bench_seconds(preset))},
      {"--loss", std::to_string(command.loss)},
      {"--duplicate", std::to_string(command.duplicates)}};
  if (preset.can != DemoPreset::CanLink::none) {
    options.insert(options.end(), {{"--can", command.can_interface},
                                   {"--can-bus", command.can_bus},
                                   {"--dbc-file", demo.folder / "sensor.dbc"}});
  }
  if (preset.laser) {
    const auto of_laser = laser_options();
    options.insert(options.end(), of_laser.begin(), of_laser.end());
  }
  if (command.response) {
    options.emplace_back("--response", *command.response);
  }
  for (const std::string& fault : command.faults) {
    options.emplace_back("--fault", fault);
  }
  std::vector<std::string> arguments;
  for (const auto& [name, value] : options) {
    arguments.insert(arguments.end(), {name, value});
  }
  return arguments;
}

Expected<void> start_bench(const DemoOptions& command, Demo& demo) {
  DYNCAL_TRY(const auto port, free_udp_port());
  std::filesystem::remove(demo.folder / "ports.json");
  DYNCAL_TRY(start(demo, "dyncal-virtual-bench", bench_arguments(command, demo, port)));
  DYNCAL_TRY(const auto ports, wait_for_json(demo.folder / "ports.json", demo.processes.back()));
  const DemoAddresses addresses{.dau_listen = fmt::format("127.0.0.1:{}", port),
                                .acs = fmt::format("127.0.0.1:{}", ports.value("acs", 0)),
                                .generator =
                                    fmt::format("127.0.0.1:{}", ports.value("generator", 0)),
                                .oscilloscope = fmt::format("127.0.0.1:{}", ports.value("dso", 0)),
                                .sensor = fmt::format("127.0.0.1:{}", ports.value("tss", 0)),
                                .can_interface = command.can_interface,
                                .can_bus = command.can_bus};
  // As "dyncal calibrate dso-delay" would have found it; the paper's value.
  DYNCAL_TRY(
      write_output_file(demo.folder / "dso-delay.json", "{\"value_s\": 236e-9, \"u_s\": 1e-9}\n"));
  return write_output_file(
      demo.folder / "bench.toml",
      demo_bench_file(demo.preset, demo.bench, addresses, uncertainty_of(demo.preset)));
}

Expected<void> start_services(Demo& demo) {
  const std::string bench_file = demo.folder / "bench.toml";
  const std::string domain = std::to_string(demo.domain);
  std::vector<std::pair<std::string, std::string>> services{
      {"dyncal-analysis", "analysis"}, {"dyncal-guard", "acs"}, {"dyncal-acs", "acs"}};
  if (demo.preset.triggered) {
    services.emplace_back("dyncal-dso", "dau");
  } else if (demo.preset.can != DemoPreset::CanLink::none) {
    services.emplace_back("dyncal-can", "dau");
  }
  if (!demo.preset.triggered && demo.preset.can != DemoPreset::CanLink::absolute_time) {
    services.emplace_back("dyncal-dau", "dau");
  }
  for (const auto& [program, role] : services) {
    std::vector<std::string> arguments{"--dds", demo.dds[role], "--domain", domain};
    if (role != "analysis") {
      arguments.insert(arguments.begin(), bench_file);
    }
    DYNCAL_TRY(start(demo, program, arguments));
  }
  return {};
}

// A service that has ended reports why in its last line, which explains more than what the others
// report of its absence.
Error explain(Demo& demo, const Error& error) {
  for (ChildProcess& process : demo.processes) {
    if (!process.running()) {
      return {error.code, fmt::format("{} ended: {}", process.name(), process.last_line())};
    }
  }
  return error;
}

Expected<void> compare_with_truth(const RunOutcome& outcome, const Demo& demo) {
  DYNCAL_TRY(const auto check, check_truth(outcome, demo.folder / "truth.json"));
  fmt::print("\nAgainst the truth of the virtual bench: {} values, the largest deviation is {:.1f} "
             "standard uncertainties ({})\n",
             check.points, check.worst, check.worst_where);
  if (check.points == 0 || !(check.worst <= agreement_limit)) {
    return fail(
        ErrorCode::no_result,
        fmt::format("the result does not agree with the truth within {} standard uncertainties",
                    agreement_limit));
  }
  return {};
}

Expected<RunOutcome> conduct(const DemoOptions& command, Demo& demo, const std::stop_token& stop) {
  DYNCAL_TRY(start_bench(command, demo));
  DYNCAL_TRY(start_services(demo));
  RunOptions run;
  run.bench_file = demo.folder / "bench.toml";
  run.output = demo.folder / "result.json";
  run.figures.folder = demo.folder;
  run.keep = command.keep;
  run.network.dds = demo.dds["run"];
  run.network.domain = demo.domain;
  return conduct_run(run, stop);
}

Expected<void> run_demo(const DemoOptions& command, const std::stop_token& stop) {
  DYNCAL_TRY(auto demo, prepare(command));
  fmt::print("Virtual bench: {}\nFiles in {}\n", demo.preset.shows, demo.folder.string());
  std::fflush(stdout);
  const auto outcome = conduct(command, demo, stop);
  if (!outcome) {
    return fail(explain(demo, outcome.error()));
  }
  DYNCAL_TRY(check_complete(*outcome));
  return compare_with_truth(*outcome, demo);
}

const Command demo_command{
    10, "demo", "run a whole virtual bench with DDS, analysis and report on this machine", add_demo,
    run_demo};

} // namespace
} // namespace dyncal::inline programs
