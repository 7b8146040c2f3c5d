// What the screen in front of Fast DDS costs (services/bus/fastdds/rtps_screen.hpp): blocks of
// samples from a writer in Fast DDS to a reader in Fast DDS over loopback, with the screen and
// without it in turns. Compared is the processor time of both ends for each block, which other
// programs of the machine hardly change; the ratio is that of the medians.
//
//   screen_cost [--rounds 5] [--blocks 4000] [--samples 256] [--max-ratio 1.25]
//
// Exit status 1 if a block is lost, or the ratio is above the one given.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <exception>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "services/bus/bus.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"

namespace {

using namespace dyncal;
using Steady = std::chrono::steady_clock;

constexpr const char* bench = "screen-cost";
constexpr std::size_t channels = 2;

struct Cost {
  double cpu_us = 0.0; // a block, both ends
  double wall_us = 0.0;
  bool whole = false;
};

double cpu_s() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

bus::Participant join(bool screened) {
  bus::ParticipantOptions options;
  options.vendor = bus::Vendor::fast_dds;
  options.domain = tests::own_dds_domain();
  options.name = "screen cost";
  options.interface_name = "lo";
  options.screened = screened;
  return bus::Participant::create(options).value();
}

Cost measure(bool screened, std::size_t blocks, std::size_t samples) {
  bus::Participant writing = join(screened);
  bus::Participant reading = join(screened);
  const auto bell = std::make_shared<bus::WakeUp>();
  auto writer = writing.writer(bus::topics::acs_samples, bench).value();
  auto reader = reading.reader(bus::topics::acs_samples, bench, bell).value();
  wire::SampleBlock block;
  block.bench(bench);
  block.source("acs");
  block.sample_count(static_cast<std::uint32_t>(samples));
  block.stamps_ns().resize(samples);
  block.values().resize(samples * channels, 1.0);
  std::size_t received = 0;
  const auto take_until = [&](std::size_t wanted) {
    const auto deadline = Steady::now() + tests::patience;
    while (received < wanted && Steady::now() < deadline) {
      received += reader.take([](const wire::SampleBlock&) {});
      bell->wait_until(Steady::now() + std::chrono::milliseconds(1));
    }
  };
  writer.write(block);
  take_until(1); // they have found each other
  const double cpu_before = cpu_s();
  const auto begin = Steady::now();
  constexpr std::size_t ahead = 100;
  for (std::size_t sent = 1; sent <= blocks; ++sent) {
    writer.write(block);
    take_until(sent > ahead ? sent - ahead : 0);
  }
  take_until(blocks + 1);
  const auto per_block = 1e6 / static_cast<double>(blocks);
  return {.cpu_us = (cpu_s() - cpu_before) * per_block,
          .wall_us = std::chrono::duration<double>(Steady::now() - begin).count() * per_block,
          .whole = received == blocks + 1};
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace

int main(int argc, char** argv) try {
  std::size_t rounds = 5;
  std::size_t blocks = 4000;
  std::size_t samples = 256;
  double max_ratio = 1.25;
  CLI::App app("What the screen in front of Fast DDS costs");
  app.add_option("--rounds", rounds)->check(CLI::PositiveNumber);
  app.add_option("--blocks", blocks)->check(CLI::PositiveNumber);
  app.add_option("--samples", samples)->check(CLI::PositiveNumber);
  app.add_option("--max-ratio", max_ratio);
  CLI11_PARSE(app, argc, argv);
  std::vector<double> with;
  std::vector<double> without;
  for (std::size_t round = 0; round < rounds; ++round) {
    for (const bool screened : {true, false}) {
      const Cost cost = measure(screened, blocks, samples);
      fmt::print("{:8}: {:.1f} us of processor a block, {:.0f} blocks a second\n",
                 screened ? "screened" : "as it is", cost.cpu_us, 1e6 / cost.wall_us);
      if (!cost.whole) {
        fmt::print("blocks were lost\n");
        return 1;
      }
      (screened ? with : without).push_back(cost.cpu_us);
    }
  }
  const double ratio = median(with) / median(without);
  fmt::print("with the screen {:.3f} times the processor time\n", ratio);
  return ratio <= max_ratio ? 0 : 1;
} catch (const std::exception& problem) {
  std::fprintf(stderr, "screen_cost: %s\n", problem.what());
  return 1;
}
