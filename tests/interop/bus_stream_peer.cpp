// One end of what bus_netns_test.sh and results_netns_test.sh send over a lossy link. Blocks:
// writes two sources, with the shortest and the longest name there can be, or reads them and says
// what is missing.
//
//   bus_stream_peer write [--live] --blocks N --rate HZ --readers N --readers-at-half M
//     waits for N readers, writes half, waits for M readers, writes the rest, then waits to be
//     ended (SIGTERM); with --live as a source that waits for no reader
//   bus_stream_peer read [--live] [--until-killed | --hang]
//     until both sources have said that they are at their end, or for ever; with --hang takes
//     nothing more once it has begun; with --live what was written before does not count as lost
//
//   bus_stream_peer write-results
//     writes results, then waits to be ended
//   bus_stream_peer read-results
//     until every one of them has come
//
// A reader of blocks prints "begun" once it has a tenth of the blocks; then, and a writer, one line
// of figures. Exit status 0: all written in time, or all read, in order, from block 0 on.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <map>
#include <set>
#include <thread>
#include <unistd.h>

#include "services/bus/bus.hpp"
#include "services/contract/sample_continuity.hpp"
#include "services/contract/source_block.hpp"
#include "services/contract/topics.hpp"

namespace {

using namespace dyncal;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr const char* bench = "netns";
std::size_t values_per_block = 5000; // 40 kB; --values
constexpr auto patience = 240s;      // each wait for another process, on a busy machine

struct Options {
  bus::ParticipantOptions participant;
  std::string dds = "fastdds";
  bool unicast = false;
  std::uint64_t blocks = 2000; // of both sources together
  double rate_hz = 400.0;
  int readers = 1;
  int readers_at_half = 0;
  bool until_killed = false;
  bool live = false;
  bool hang = false;

  [[nodiscard]] bus::Profile profile() const {
    return live ? bus::Profile::live_samples : bus::Profile::samples;
  }
};

std::vector<std::string> source_names() {
  return {"a", std::string(64, 'z')};
}

double value_of(std::uint64_t block, std::size_t index) {
  return static_cast<double>(block) + static_cast<double>(index) * 1e-4;
}

wire::SampleBlock make_block(const std::string& source, std::uint64_t session, std::uint64_t number,
                             bool last) {
  wire::SampleBlock block;
  block.bench(bench);
  block.source(source);
  block.session(session);
  block.block(number);
  block.first_sample(number * values_per_block);
  block.sample_count(static_cast<std::uint32_t>(values_per_block));
  block.channel_count(1);
  block.end_of_stream(last);
  block.values().resize(values_per_block);
  for (std::size_t i = 0; i < values_per_block; ++i) {
    block.values()[i] = value_of(number, i);
  }
  return block;
}

struct WriteFigures {
  Clock::duration max_write{};
  std::uint64_t not_written = 0;
};

void wait_until_ended() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  int signal = 0;
  sigwait(&signals, &signal);
}

using Writers = std::vector<bus::Writer<wire::SampleBlock>>;

// The number of readers has no bell.
bool wait_for_readers(const Writers& writers, int wanted) {
  const auto give_up = Clock::now() + patience;
  for (const auto& writer : writers) {
    while (writer.matched_readers() < wanted) {
      if (Clock::now() > give_up) {
        std::printf("only %d of %d readers\n", writer.matched_readers(), wanted);
        return false;
      }
      std::this_thread::sleep_for(5ms);
    }
  }
  return true;
}

int write_stream(bus::Participant& participant, const Options& options) {
  Writers writers;
  for (std::size_t i = 0; i < source_names().size(); ++i) {
    writers.push_back(
        participant.writer<wire::SampleBlock>(bus::topics::dau_samples, options.profile(), bench)
            .value());
  }
  if (!wait_for_readers(writers, options.readers)) {
    return 1;
  }

  const auto session =
      static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  const auto names = source_names();
  const std::uint64_t rounds = options.blocks / names.size();
  auto begin = Clock::now();
  WriteFigures figures;
  for (std::uint64_t i = 0; i < rounds * names.size(); ++i) {
    if (i == rounds) {
      const auto waiting = Clock::now();
      if (!wait_for_readers(writers, options.readers_at_half)) {
        return 1;
      }
      begin += Clock::now() - waiting;
    }
    std::this_thread::sleep_until(
        begin + std::chrono::duration_cast<Clock::duration>(
                    std::chrono::duration<double>(static_cast<double>(i) / options.rate_hz)));
    const std::size_t source = i % names.size();
    const std::uint64_t number = i / names.size();
    const wire::SampleBlock block =
        make_block(names[source], session, number, number + 1 == rounds);
    const auto before = Clock::now();
    if (writers[source].write(block, 60s) != bus::WriteOutcome::written) {
      ++figures.not_written;
    }
    figures.max_write = std::max(figures.max_write, Clock::now() - before);
  }
  const double lasted_s = std::chrono::duration<double>(Clock::now() - begin).count();
  std::printf("wrote %llu blocks in %.1f s, longest write %.3f s, not written %llu\n",
              static_cast<unsigned long long>(rounds * names.size()), lasted_s,
              std::chrono::duration<double>(figures.max_write).count(),
              static_cast<unsigned long long>(figures.not_written));
  std::fflush(stdout);
  wait_until_ended();
  return figures.not_written == 0 && figures.max_write < 60s ? 0 : 1;
}

int read_stream(bus::Participant& participant, const Options& options) {
  auto bell = std::make_shared<bus::WakeUp>();
  auto reader =
      participant.reader<wire::SampleBlock>(bus::topics::dau_samples, options.profile(), "*", bell)
          .value();
  std::map<std::string, contract::SampleContinuity> continuity; // by source
  std::size_t ended = 0;
  std::uint64_t wrong = 0;
  std::uint64_t begun_late = 0;
  std::uint64_t taken = 0;
  const auto consume = [&](const wire::SampleBlock& block) {
    const auto finding = continuity[block.source().to_string()].add(contract::view_block(block));
    if (finding.first) {
      begun_late += options.live ? 0 : block.block();
    }
    if (!finding.continuous()) {
      ++wrong;
    }
    for (std::size_t i = 0; i < block.values().size(); i += 77) {
      if (block.values()[i] != value_of(block.block(), i)) {
        ++wrong;
      }
    }
    if (block.values().size() != values_per_block) {
      ++wrong;
    }
    if (block.end_of_stream()) {
      ++ended;
    }
    if (++taken == options.blocks / 10) {
      std::printf("begun\n");
      std::fflush(stdout);
      if (options.hang) {
        pause();
      }
    }
  };
  const auto give_up = Clock::now() + patience;
  while ((ended < source_names().size() || options.until_killed) && Clock::now() < give_up) {
    bell->wait_until(Clock::now() + 100ms);
    reader.take(consume);
  }
  std::uint64_t blocks = 0;
  std::uint64_t lost = begun_late;
  for (const std::string& source : source_names()) {
    const contract::ContinuityCounts& counts = continuity[source].counts();
    blocks += counts.blocks;
    lost += counts.missing_blocks + counts.duplicates;
  }
  std::printf("read %llu blocks, lost %llu, wrong %llu, at the end of %zu sources\n",
              static_cast<unsigned long long>(blocks), static_cast<unsigned long long>(lost),
              static_cast<unsigned long long>(wrong), ended);
  return ended == source_names().size() && lost == 0 && wrong == 0 ? 0 : 1;
}

constexpr std::uint32_t result_count = 150;

// One to eight fragments in both vendors.
std::size_t bytes_of(std::uint32_t step) {
  return 500 + std::size_t{step} * 610 % 9000;
}

int write_results(bus::Participant& participant) {
  auto writer = participant.writer(bus::topics::calibration_result, bench).value();
  wire::CalibrationResult result;
  result.bench(bench);
  result.run("r");
  result.channel("dau/acceleration_z");
  for (std::uint32_t step = 0; step < result_count; ++step) {
    result.step(step);
    result.problem(std::string(bytes_of(step), 'p'));
    if (writer.write(result) != bus::WriteOutcome::written) {
      std::printf("result %u was not written\n", step);
      return 1;
    }
  }
  wait_until_ended();
  return 0;
}

int read_results(bus::Participant& participant) {
  auto bell = std::make_shared<bus::WakeUp>();
  auto reader = participant.reader(bus::topics::calibration_result, "*", bell).value();
  std::set<std::uint32_t> steps;
  const auto give_up = Clock::now() + patience;
  while (steps.size() < result_count && Clock::now() < give_up) {
    bell->wait_until(Clock::now() + 100ms);
    reader.take([&](const wire::CalibrationResult& result) {
      if (result.problem().size() == bytes_of(result.step())) {
        steps.insert(result.step());
      }
    });
  }
  std::printf("read %zu of %u results\n", steps.size(), result_count);
  return steps.size() == result_count ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
  // Blocked before the vendor's threads begin, so that only wait_until_ended() hears of it.
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);

  Options options;
  CLI::App app("One end of a stream of sample blocks");
  app.require_subcommand(1);
  app.add_option("--dds", options.dds);
  app.add_option("--domain", options.participant.domain);
  app.add_flag("--unicast", options.unicast);
  app.add_option("--peer", options.participant.peers);
  app.add_option("--interface", options.participant.interface_name);
  auto* write = app.add_subcommand("write")->fallthrough();
  app.add_option("--blocks", options.blocks);
  app.add_option("--rate", options.rate_hz);
  write->add_option("--readers", options.readers);
  write->add_option("--readers-at-half", options.readers_at_half);
  auto* read = app.add_subcommand("read")->fallthrough();
  read->add_flag("--until-killed", options.until_killed);
  read->add_flag("--hang", options.hang);
  app.add_flag("--live", options.live);
  app.add_option("--values", values_per_block);
  auto* write_all_results = app.add_subcommand("write-results")->fallthrough();
  auto* read_all_results = app.add_subcommand("read-results")->fallthrough();
  CLI11_PARSE(app, argc, argv);
  if (write->parsed() || write_all_results->parsed()) {
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  }

  const auto vendor = bus::parse_vendor(options.dds);
  if (!vendor) {
    std::fprintf(stderr, "%s\n", vendor.error().message.c_str());
    return 2;
  }
  options.participant.vendor = *vendor;
  options.participant.multicast = !options.unicast;
  options.participant.name = "stream peer";
  auto participant = bus::Participant::create(options.participant);
  if (!participant) {
    std::fprintf(stderr, "%s\n", participant.error().message.c_str());
    return 2;
  }
  if (write_all_results->parsed()) {
    return write_results(*participant);
  }
  if (read_all_results->parsed()) {
    return read_results(*participant);
  }
  return write->parsed() ? write_stream(*participant, options) : read_stream(*participant, options);
}
