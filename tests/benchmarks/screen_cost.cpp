// What the screen in front of Fast DDS costs (services/bus/fastdds/screen): blocks of samples from
// a writer to a reader over loopback, with the screen and without it in turns, each in a process of
// its own. Compared is the processor time of both for each block. How many blocks one wake-up
// serves, and so what a block costs, changes by a third from round to round: the ratio is that of
// the cheapest rounds. Seen were 1.1 to 1.35.
//
//   screen_cost [--rounds 15] [--blocks 4000] [--samples 256] [--max-ratio 1.5]
//
// Exit status 1 if a block is lost, or a ratio is above the one given.
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <functional>
#include <stdexcept>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "services/bus/bus.hpp"
#include "services/bus/vendor.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace {

using namespace dyncal;
using Steady = std::chrono::steady_clock;

constexpr const char* bench = "screen-cost";
constexpr std::size_t channels = 2;
constexpr std::size_t blocks_of_credit = 50; // that the reader has got, and the writer may send
constexpr std::size_t ahead = 100;

struct Options {
  int domain = tests::own_dds_domain();
  std::size_t rounds = 15;
  std::size_t blocks = 4000;
  std::size_t samples = 256;
  double max_ratio = 1.5;
};

double cpu_s() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class Pipe {
public:
  Pipe() {
    if (pipe(ends_.data()) != 0) {
      throw std::runtime_error("cannot make a pipe");
    }
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    for (const int end : ends_) {
      close(end);
    }
  }

  template <class Value>
  void put(const Value& value) {
    if (write(ends_[1], &value, sizeof value) != sizeof value) {
      throw std::runtime_error("cannot write to a pipe");
    }
  }
  [[nodiscard]] bool has_some(std::chrono::milliseconds limit) const {
    pollfd end{.fd = ends_[0], .events = POLLIN, .revents = 0};
    return poll(&end, 1, static_cast<int>(limit.count())) == 1;
  }
  template <class Value>
  Value get() {
    Value value{};
    if (!has_some(tests::patience) || read(ends_[0], &value, sizeof value) != sizeof value) {
      throw std::runtime_error("blocks were lost");
    }
    return value;
  }

private:
  std::array<int, 2> ends_{};
};

bus::Participant join(bool screened, int domain) {
  bus::ParticipantOptions options;
  options.vendor = bus::Vendor::fast_dds;
  options.domain = domain;
  options.name = "screen cost";
  options.interface_name = "lo";
  options.screened = screened;
  return bus::Participant::create(options).value();
}

// Block 0 until the reader has shown that it is there, then the others as it has room. Returns the
// processor time.
double write_blocks(bool screened, const Options& options, Pipe& credit) {
  bus::Participant participant = join(screened, options.domain);
  auto writer = participant.writer(bus::topics::acs_samples, bench).value();
  wire::SampleBlock block;
  block.bench(bench);
  block.source("acs");
  block.sample_count(static_cast<std::uint32_t>(options.samples));
  block.stamps_ns().resize(options.samples);
  block.values().resize(options.samples * channels, 1.0);
  const auto deadline = Steady::now() + tests::patience;
  do {
    writer.write(block);
  } while (!credit.has_some(std::chrono::milliseconds(50)) && Steady::now() < deadline);
  std::size_t allowed = credit.get<char>() != 0 ? ahead : 0;
  const double before_s = cpu_s();
  for (std::size_t number = 1; number <= options.blocks; ++number) {
    for (; number > allowed; allowed += blocks_of_credit) {
      (void)credit.get<char>();
    }
    block.block(number);
    writer.write(block);
  }
  writer.wait_for_acknowledgments(tests::patience);
  return cpu_s() - before_s;
}

double read_blocks(bool screened, const Options& options, Pipe& credit) {
  bus::Participant participant = join(screened, options.domain);
  const auto bell = std::make_shared<bus::WakeUp>();
  auto reader = participant.reader(bus::topics::acs_samples, bench, bell).value();
  const auto deadline = Steady::now() + tests::patience;
  double before_s = -1.0;
  std::size_t received = 0;
  while (received < options.blocks && Steady::now() < deadline) {
    bell->wait_until(deadline);
    reader.take([&](const wire::SampleBlock& block) {
      if (before_s < 0.0) {
        before_s = cpu_s();
        credit.put('c');
      }
      if (block.block() == 0) {
        return;
      }
      if (block.block() != ++received) {
        throw std::runtime_error(
            fmt::format("block {} came as number {}", block.block(), received));
      }
      if (received % blocks_of_credit == 0) {
        credit.put('c');
      }
    });
  }
  if (received < options.blocks) {
    throw std::runtime_error(fmt::format("{} blocks of {} have come", received, options.blocks));
  }
  return cpu_s() - before_s;
}

pid_t start(Pipe& result, const std::function<double()>& work) {
  const pid_t child = fork();
  if (child != 0) {
    return child;
  }
  try {
    result.put(work());
    std::_Exit(0);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "screen_cost: %s\n", problem.what());
    std::_Exit(1);
  }
}

// Of both ends, a block.
double measure_us(bool screened, const Options& options) {
  Pipe credit;
  Pipe used_s;
  const std::array<pid_t, 2> children{
      start(used_s, [&] { return read_blocks(screened, options, credit); }),
      start(used_s, [&] { return write_blocks(screened, options, credit); })};
  bool all_well = true;
  for (const pid_t child : children) {
    int status = 0;
    all_well = waitpid(child, &status, 0) == child && status == 0 && all_well;
  }
  if (!all_well) {
    throw std::runtime_error("an end of the connection has failed");
  }
  const double both_s = used_s.get<double>() + used_s.get<double>();
  return 1e6 * both_s / static_cast<double>(options.blocks);
}

// With the screen to without.
double ratio_of(const Options& options) {
  std::vector<double> with;
  std::vector<double> without;
  for (std::size_t round = 0; round < options.rounds; ++round) {
    for (const bool screened : {true, false}) {
      const double cost_us = measure_us(screened, options);
      fmt::print("{:8}: {:.1f} us of processor a block\n", screened ? "screened" : "as it is",
                 cost_us);
      (screened ? with : without).push_back(cost_us);
    }
  }
  return std::ranges::min(with) / std::ranges::min(without);
}

} // namespace

int main(int argc, char** argv) try {
  Options options;
  CLI::App app("What the screen in front of Fast DDS costs");
  app.add_option("--rounds", options.rounds)->check(CLI::PositiveNumber);
  app.add_option("--blocks", options.blocks)->check(CLI::PositiveNumber);
  app.add_option("--samples", options.samples)->check(CLI::PositiveNumber);
  app.add_option("--max-ratio", options.max_ratio);
  CLI11_PARSE(app, argc, argv);
  const double ratio = ratio_of(options);
  fmt::print("with the screen: {:.3f} times the processor time\n", ratio);
  return ratio <= options.max_ratio ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "screen_cost: %s\n", problem.what());
  return 1;
}
