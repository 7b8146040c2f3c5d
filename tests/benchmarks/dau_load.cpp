// Load of dyncal-dau: units send real datagrams over UDP at their real pace to a running dyncal-dau
// while one subscriber reads all of it. Reports lost samples, the processor time of dyncal-dau, as
// a fraction of one core and for each block, and the latency from datagram to reader.
//   dau_load [--dds V] [--vendors mixed|same] [--units 16] [--sensors 4] [--rate 1000]
//            [--channels 13] [--seconds 20]
// Each unit is a bench.
// With `--against PROGRAM [--rounds 5]` an older dyncal-dau takes turns with this one. Printed is
// the ratio of what a block costs them, each in its quickest round: others disturb, and never help.
// Exit status 1 when a sample was lost, or the ratio is above --max-ratio.
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "drivers/smartup/sensor_id.hpp"
#include "drivers/utc_clock.hpp"
#include "services/bus/bus.hpp"
#include "services/contract/topics.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"
#include "tests/system/program_run.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/udp_port.hpp"
#include "tests/unit/drivers/smartup/datagram_writer.hpp"
#include "tests/unit/drivers/smartup/udp_sender.hpp"
#include "tests/unit/services/programs/dau/bench_text.hpp"

namespace {

using namespace dyncal;
using Clock = std::chrono::steady_clock;

struct Load {
  std::string dds = "fastdds";
  std::string vendors = "mixed";
  int domain = tests::own_dds_domain();
  std::string program = DYNCAL_DAU;
  std::string against; // another one; empty: none
  int rounds = 5;
  double max_ratio = std::numeric_limits<double>::infinity();
  std::uint32_t units = 16;
  std::uint32_t sensors = 4;
  int rate_hz = 1000;
  int channels = 13;
  double seconds = 20.0;
};

std::uint32_t sensor_id(std::uint32_t unit, std::uint32_t sensor) {
  return (0xb000U + unit) << 16U | (sensor + 1) << 8U;
}

// One unit: fills datagrams as the firmware does, up to 873 bytes and more, and sends them from its
// own port.
class Unit {
public:
  Unit(const Load& load, std::uint32_t number, std::uint16_t port)
      : load_(load), number_(number), sender_(port) {
    for (int channel = 1; channel <= load.channels; ++channel) {
      data_.values.emplace_back(channel, 0.25F * static_cast<float>(channel));
    }
    data_.time_uncertainty_ns = 84;
  }

  void describe() {
    for (std::uint32_t sensor = 0; sensor < load_.sensors; ++sensor) {
      for (const auto& bytes : tests::mpu9250_descriptions(sensor_id(number_, sensor))) {
        sender_.send(bytes);
      }
    }
  }

  // One sample of every sensor.
  void sample(std::int64_t stamp_ns) {
    ++data_.sample_number;
    data_.stamp_ns = stamp_ns;
    for (std::uint32_t sensor = 0; sensor < load_.sensors; ++sensor) {
      data_.sensor = sensor_id(number_, sensor);
      datagram_.data(data_);
      if (datagram_.bytes().size() < full_datagram) {
        continue;
      }
      sender_.send(datagram_.bytes());
      datagram_ = tests::DatagramWriter("DATA");
    }
  }

  void flush() { sender_.send(datagram_.bytes()); }

private:
  static constexpr std::size_t full_datagram = 873;

  const Load& load_;
  const std::uint32_t number_;
  tests::UdpSender sender_;
  tests::DatagramWriter datagram_{"DATA"};
  tests::DatagramWriter::Data data_{.sample_number = 0};
};

// Sends for the whole time, in steps of two milliseconds; returns samples sent per sensor.
std::uint32_t send_all(const Load& load, std::uint16_t port) {
  std::vector<std::unique_ptr<Unit>> units;
  for (std::uint32_t i = 0; i < load.units; ++i) {
    units.push_back(std::make_unique<Unit>(load, i, port));
  }
  const auto begin = Clock::now();
  const std::int64_t begin_ns = utc_now_ns();
  const auto total = static_cast<std::uint32_t>(load.seconds * load.rate_hz);
  std::uint32_t sent = 0;
  double next_description_s = 0.0;
  while (sent < total) {
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin).count();
    const auto due = std::min(total, static_cast<std::uint32_t>(elapsed_s * load.rate_hz));
    for (auto& unit : units) {
      for (std::uint32_t n = sent; n < due; ++n) {
        unit->sample(begin_ns + std::int64_t{n} * 1'000'000'000 / load.rate_hz);
      }
      if (elapsed_s >= next_description_s) {
        unit->describe();
      }
    }
    if (elapsed_s >= next_description_s) {
      next_description_s += 4.0;
    }
    sent = due;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (auto& unit : units) {
    unit->flush();
  }
  return sent;
}

// Reads everything of all benches and keeps the account of each source.
class Subscriber {
public:
  Subscriber(const Load& load, bus::Participant& network)
      : reader_(*network.reader<wire::SampleBlock>(bus::topics::dau_samples, bus::Profile::samples,
                                                   "*", wake_up_)),
        status_(*network.reader<wire::SourceStatus>(bus::topics::source_status, bus::Profile::state,
                                                    "*", wake_up_)),
        sources_(std::size_t{load.units} * load.sensors) {}

  void take() {
    wake_up_->wait_until(Clock::now() + std::chrono::milliseconds(100));
    reader_.take([&](const wire::SampleBlock& block) { add(block); });
    status_.take([&](const wire::SourceStatus& status) {
      const std::string name = std::string(status.bench().c_str()) + "/" + status.source().c_str();
      lost_by_account_[name] =
          status.lost_in_device() + status.lost_in_transit() + status.dropped_in_service();
      for (const auto& cause : status.causes()) {
        causes_[cause.name()] = std::max(causes_[cause.name()], cause.value());
      }
    });
  }

  [[nodiscard]] std::size_t blocks() const { return latencies_s_.size(); }
  [[nodiscard]] bool all_ready() const { return lost_by_account_.size() == sources_; }

  void report(std::uint32_t sent) const {
    std::uint64_t received = 0;
    std::uint64_t gaps = 0;
    for (const auto& [name, account] : accounts_) {
      received += account.samples;
      gaps += account.gaps;
    }
    const std::uint64_t by_account =
        std::accumulate(lost_by_account_.begin(), lost_by_account_.end(), std::uint64_t{0},
                        [](auto sum, const auto& entry) { return sum + entry.second; });
    fmt::print("sent {} samples, received {}, gaps seen by the reader {}, lost by the service's "
               "account {}\n",
               std::uint64_t{sent} * sources_, received, gaps, by_account);
    for (const auto& [cause, count] : causes_) {
      fmt::print("  {}: {}\n", cause, count);
    }
    auto latencies = latencies_s_;
    std::ranges::sort(latencies);
    if (!latencies.empty()) {
      fmt::print("latency from the last datagram of a block to the reader: median {:.1f} ms, 99 % "
                 "{:.1f} ms, largest {:.1f} ms\n",
                 latencies[latencies.size() / 2] * 1e3,
                 latencies[latencies.size() * 99 / 100] * 1e3, latencies.back() * 1e3);
    }
  }

  [[nodiscard]] std::uint64_t received() const {
    return std::accumulate(accounts_.begin(), accounts_.end(), std::uint64_t{0},
                           [](auto sum, const auto& entry) { return sum + entry.second.samples; });
  }

private:
  struct Account {
    std::uint64_t samples = 0;
    std::uint64_t next = 1;
    std::uint64_t gaps = 0;
  };

  void add(const wire::SampleBlock& block) {
    if (block.sample_count() == 0) {
      return;
    }
    Account& account = accounts_[std::string(block.bench().c_str()) + "/" + block.source().c_str()];
    if (block.first_sample() != account.next) {
      ++account.gaps;
    }
    account.next = block.first_sample() + block.sample_count();
    account.samples += block.sample_count();
    latencies_s_.push_back(static_cast<double>(utc_now_ns() - block.received_utc_ns()) * 1e-9);
  }

  std::shared_ptr<bus::WakeUp> wake_up_ = std::make_shared<bus::WakeUp>();
  bus::Reader<wire::SampleBlock> reader_;
  bus::Reader<wire::SourceStatus> status_;
  std::size_t sources_;
  std::map<std::string, Account> accounts_;
  std::map<std::string, std::uint64_t> lost_by_account_;
  std::map<std::string, std::uint64_t> causes_;
  std::vector<double> latencies_s_;
};

std::vector<std::string> write_benches(const Load& load, const tests::TemporaryFolder& folder,
                                       std::uint16_t port) {
  std::vector<std::string> files;
  const std::string listen = "127.0.0.1:" + std::to_string(port);
  for (std::uint32_t unit = 0; unit < load.units; ++unit) {
    std::string sources;
    for (std::uint32_t sensor = 0; sensor < load.sensors; ++sensor) {
      sources += tests::smartup_source("dau-" + std::to_string(sensor), listen,
                                       drivers::smartup::sensor_text(sensor_id(unit, sensor)));
    }
    const std::string bench = "load-" + std::to_string(getpid()) + "-" + std::to_string(unit);
    files.push_back(folder.write(bench + ".toml", tests::bench_text(bench, sources, "dau-0")));
  }
  return files;
}

std::vector<std::string> arguments_of(const Load& load, std::vector<std::string> benches) {
  std::vector<std::string> arguments{"--dds", load.dds, "--domain", std::to_string(load.domain)};
  if (load.vendors != "mixed") { // an older one has no such option
    arguments.insert(arguments.end(), {"--vendors", load.vendors});
  }
  std::ranges::move(benches, std::back_inserter(arguments));
  return arguments;
}

// Processor time of the only program that this thread has started.
double cpu_of_child_s() {
  pid_t child = 0;
  std::ifstream("/proc/thread-self/children") >> child;
  clockid_t clock{};
  std::timespec time{};
  if (child == 0 || clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &time) != 0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

bool wait_until_ready(Subscriber& subscriber) {
  const auto limit = Clock::now() + tests::patience;
  while (!subscriber.all_ready() && Clock::now() < limit) {
    subscriber.take();
  }
  return subscriber.all_ready();
}

std::uint64_t samples_to_send(const Load& load) {
  return std::uint64_t{static_cast<std::uint32_t>(load.seconds * load.rate_hz)} * load.units *
         load.sensors;
}

struct Outcome {
  int status = 2;
  double block_us = std::numeric_limits<double>::quiet_NaN(); // processor time, without start, end
};

Outcome run(const Load& load) {
  bus::ParticipantOptions options;
  options.vendor = *bus::parse_vendor(load.dds);
  options.laboratory =
      load.vendors == "same" ? bus::LaboratoryVendors::same : bus::LaboratoryVendors::mixed;
  options.domain = load.domain;
  auto network = bus::Participant::create(options);
  if (!network) {
    fmt::print(stderr, "{}\n", network.error().message);
    return {};
  }
  Subscriber subscriber(load, *network);
  const tests::TemporaryFolder folder;
  const std::uint16_t port = tests::own_udp_port();
  tests::ProgramRun program(load.program, arguments_of(load, write_benches(load, folder, port)),
                            folder.path());
  if (!wait_until_ready(subscriber)) {
    fmt::print(stderr, "dyncal-dau is not there:\n{}", program.errors());
    return {};
  }

  const auto begin = Clock::now();
  const double cpu_before_s = cpu_of_child_s();
  std::atomic<std::uint32_t> sent{0};
  std::jthread sender([&] { sent = send_all(load, port); });
  const auto limit =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(
                         std::chrono::duration<double>(load.seconds) + tests::patience);
  const std::uint64_t expected = samples_to_send(load);
  while (subscriber.received() < expected && Clock::now() < limit) {
    subscriber.take();
  }
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin).count();
  Outcome outcome;
  outcome.block_us =
      1e6 * (cpu_of_child_s() - cpu_before_s) / static_cast<double>(subscriber.blocks());
  sender.join();
  const auto settled_by = Clock::now() + std::chrono::seconds(1); // the last status
  while (Clock::now() < settled_by) {
    subscriber.take();
  }
  program.send(SIGTERM);
  const auto exit = program.wait(tests::patience);

  fmt::print("{}, {}: {} units x {} sensors x {} S/s x {} channels for {} s, in {:.1f} s\n",
             load.dds, load.vendors, load.units, load.sensors, load.rate_hz, load.channels,
             load.seconds, elapsed_s);
  subscriber.report(sent);
  if (exit) {
    fmt::print("CPU of dyncal-dau, start and end included: {:.3f} of one core\n",
               program.cpu_s() / elapsed_s);
    fmt::print("CPU of dyncal-dau: {:.1f} us a block\n", outcome.block_us);
  }
  outcome.status = subscriber.received() == expected && exit == 0 ? 0 : 1;
  if (subscriber.received() != expected) {
    fmt::print("LOST {} samples\n{}", expected - subscriber.received(), program.errors());
  }
  return outcome;
}

int compare(Load load) {
  const std::array programs{load.program, load.against};
  std::array<double, 2> quickest_us;
  quickest_us.fill(std::numeric_limits<double>::infinity());
  for (int round = 0; round < load.rounds; ++round) {
    for (std::size_t i = 0; i < programs.size(); ++i) {
      load.program = programs[i];
      const Outcome outcome = run(load);
      if (outcome.status != 0) {
        return outcome.status;
      }
      quickest_us[i] = std::min(quickest_us[i], outcome.block_us);
    }
  }
  const double ratio = quickest_us[0] / quickest_us[1];
  fmt::print("{}: a block costs {:.1f} us, with {} {:.1f} us: ratio {:.3f}\n", load.dds,
             quickest_us[0], load.against, quickest_us[1], ratio);
  return ratio <= load.max_ratio ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) try {
  Load load;
  CLI::App app{"Load of dyncal-dau"};
  app.add_option("--dds", load.dds);
  app.add_option("--vendors", load.vendors)->check(CLI::IsMember({"mixed", "same"}));
  app.add_option("--domain", load.domain);
  app.add_option("--program", load.program);
  app.add_option("--against", load.against);
  app.add_option("--rounds", load.rounds)->check(CLI::PositiveNumber);
  app.add_option("--max-ratio", load.max_ratio);
  app.add_option("--units", load.units);
  app.add_option("--sensors", load.sensors);
  app.add_option("--rate", load.rate_hz);
  app.add_option("--channels", load.channels);
  app.add_option("--seconds", load.seconds);
  CLI11_PARSE(app, argc, argv);
  return load.against.empty() ? run(load).status : compare(load);
} catch (const std::exception& problem) {
  std::fprintf(stderr, "dau_load: %s\n", problem.what());
  return 2;
}
