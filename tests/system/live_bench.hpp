// A virtual bench with its source services and an analysis service on a DDS domain of the test's
// own, for commands that conduct runs.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "tests/system/instrument_question.hpp"
#include "tests/system/laboratory.hpp"
#include "tests/udp_port.hpp"

namespace dyncal::tests {

struct LiveBenchSettings {
  std::vector<std::string> bench_arguments; // of dyncal-virtual-bench
  std::string excitation;                   // lines of the bench file's tables
  std::string generator = "level_per_volt = 50.0\n";
  std::string source_dau = R"(time_base = "utc")";
  std::string source_acs{}; // lines of its table; empty: the stream of the virtual bench
  std::string reference = "reference = \"acs/reference\"\nsync_acs = \"acs/sync\"\n";
  std::string rest{};             // further tables
  std::string dds = "cyclonedds"; // of all programs; as without --dds
};

class LiveBench {
public:
  LiveBench(const std::filesystem::path& folder, const LiveBenchSettings& settings)
      : folder_(folder), settings_(settings), laboratory_(folder) {
    const std::string dau = fmt::format("127.0.0.1:{}", own_udp_port());
    std::vector<std::string> arguments{"--preset", "mpu9250-ptb",        "--dau",
                                       dau,        "--ports-file",       folder / "ports.json",
                                       "--truth",  folder / "truth.json"};
    arguments.insert(arguments.end(), settings.bench_arguments.begin(),
                     settings.bench_arguments.end());
    virtual_bench_ = std::make_unique<ProgramRun>("dyncal-virtual-bench", arguments, folder);
    EXPECT_TRUE(virtual_bench_->wait_for_error_text("datagrams to", patience))
        << virtual_bench_->errors();
    const auto ports = read_json(folder / "ports.json");
    generator_port_ = ports["generator"].get<int>();
    write_bench_file(settings, dau, ports["acs"].get<int>());
    start_service("dyncal-analysis");
    start_service("dyncal-dau");
    start_service("dyncal-acs");
  }

  [[nodiscard]] std::filesystem::path bench_file() const { return folder_ / "bench.toml"; }
  [[nodiscard]] int generator_port() const { return generator_port_; }
  [[nodiscard]] nlohmann::json truth() const { return read_json(folder_ / "truth.json"); }
  // The answer of the bench's generator.
  [[nodiscard]] std::string ask_generator(const std::string& query) const {
    return ask_instrument(generator_port_, query);
  }
  void tell_generator(const std::string& command) const {
    static_cast<void>(ask_generator(command));
  }
  // True as soon as the generator's output is in this state, "ON" or "OFF".
  [[nodiscard]] bool wait_for_output(const std::string& state) const {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < deadline) {
      if (ask_generator(":OUTPut1?") == state) {
        return true;
      }
    }
    return false;
  }
  void signal_bench(int signal) { virtual_bench_->send(signal); }
  ProgramRun& start(const std::vector<std::string>& arguments) {
    return laboratory_.start("dyncal", arguments, settings_.dds);
  }
  // Again, if it runs or did: the newest is what service() returns.
  ProgramRun& start_service(const std::string& program) {
    return start_service(program, bench_file());
  }
  ProgramRun& start_service(const std::string& program, const std::filesystem::path& bench_file) {
    std::vector<std::string> arguments;
    if (program != "dyncal-analysis") {
      arguments.push_back(bench_file);
    }
    ProgramRun& started = laboratory_.start(program, arguments, settings_.dds);
    services_[program] = &started;
    return started;
  }
  [[nodiscard]] ProgramRun& service(const std::string& program) { return *services_.at(program); }
  // The bench file once more, with `text` in place of what one of its lines begins with.
  std::filesystem::path changed_bench_file(const std::string& name, const std::string& line_begin,
                                           const std::string& text) const {
    std::ifstream in(bench_file());
    std::ofstream out(folder_ / name);
    for (std::string line; std::getline(in, line);) {
      out << (line.starts_with(line_begin) ? text : line) << '\n';
    }
    return folder_ / name;
  }

private:
  void write_bench_file(const LiveBenchSettings& settings, const std::string& dau,
                        int acs_port) const {
    std::ofstream(bench_file())
        << "bench = \"live\"\n[excitation]\n"
        << settings.excitation << "\n[generator]\n"
        << fmt::format("driver = \"scpi\"\naddress = \"127.0.0.1:{}\"\n", generator_port_)
        << settings.generator << "\n[sources.dau]\ndriver = \"smartup\"\nsensor = \"0xbccb0100\"\n"
        << "listen = \"" << dau << "\"\nchannels = { Data_11 = \"sync\" }\n"
        << settings.source_dau << "\n[sources.acs]\n"
        << (settings.source_acs.empty()
                ? fmt::format("driver = \"socket\"\naddress = \"127.0.0.1:{}\"\n", acs_port)
                : settings.source_acs)
        << "[method]\nkind = \"sample-timestamping\"\n"
        << settings.reference << R"(sync_dau = "dau/sync"
dut = ["dau/acceleration_x", "dau/acceleration_y", "dau/acceleration_z"]
[uncertainty]
reference_magnitude_rel = 1e-3
reference_phase_rad = 1.7e-3
acs_delay_s = 1e-8
)" << settings.rest;
  }

  std::filesystem::path folder_;
  LiveBenchSettings settings_;
  int generator_port_ = 0;
  std::unique_ptr<ProgramRun> virtual_bench_;
  Laboratory laboratory_;
  std::map<std::string, ProgramRun*> services_; // of the laboratory
};

} // namespace dyncal::tests
