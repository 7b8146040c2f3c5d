// Four benches that publish, and what recorders acknowledge: bench_publisher DOMAIN DDS [MB_PER_S]
//
// Prints a line "stored N FILE" for every status of a recorder, until standard input ends.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <unistd.h>

#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"

namespace {

using namespace dyncal;
using namespace std::chrono_literals;

constexpr int benches = 4;
constexpr std::uint32_t max_samples = 8000; // of a block: 64 kB

wire::SampleBlock block_of(const std::string& bench, std::uint64_t number, std::uint32_t samples) {
  wire::SampleBlock block;
  block.bench(bench);
  block.source("acs");
  block.session(77);
  block.block(number);
  block.first_sample(number * samples);
  block.sample_count(samples);
  block.channel_count(1);
  block.interval_numerator_ns(20'000'000);
  block.interval_denominator(samples);
  block.received_utc_ns(bus::system_clock().utc_now_ns());
  for (std::uint32_t i = 0; i < samples; ++i) {
    block.values().push_back(0.001 * static_cast<double>(number * samples + i));
  }
  return block;
}

wire::SourceDescription description_of(const std::string& bench) {
  wire::SourceDescription description;
  description.bench(bench);
  description.source("acs");
  description.session(77);
  description.kind(wire::SOURCE_ACS);
  description.driver("bench_publisher");
  description.channels().resize(1);
  description.channels()[0].name("reference");
  return description;
}

void publish(bus::Participant& participant, const std::string& bench, double samples_per_s,
             const std::atomic<bool>& over) {
  const auto samples = std::min(max_samples, static_cast<std::uint32_t>(0.02 * samples_per_s));
  const std::chrono::duration<double> interval(samples / samples_per_s);
  auto descriptions = participant.writer(bus::topics::source_description, bench).value();
  auto blocks =
      participant
          .writer<wire::SampleBlock>(bus::topics::acs_samples, bus::Profile::live_samples, bench)
          .value();
  descriptions.write(description_of(bench));
  auto next = std::chrono::steady_clock::now();
  for (std::uint64_t number = 0; !over; ++number) {
    blocks.write(block_of(bench, number, samples));
    next += std::chrono::duration_cast<std::chrono::nanoseconds>(interval);
    std::this_thread::sleep_until(next);
  }
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    return 2;
  }
  bus::ParticipantOptions options;
  options.domain = std::stoi(argv[1]);
  options.vendor = bus::parse_vendor(argv[2]).value();
  options.name = "bench_publisher";
  const double mb_per_s = argc > 3 ? std::stod(argv[3]) : 1.6;
  const double samples_per_s = mb_per_s * 1e6 / 8.0 / benches;
  auto participant = bus::Participant::create(options).value();
  const auto bell = std::make_shared<bus::WakeUp>();
  auto states = participant.reader(bus::topics::recorder_status, "*", bell).value();
  std::atomic<bool> over{false};
  std::vector<std::jthread> threads;
  for (int i = 1; i <= benches; ++i) {
    threads.emplace_back(
        [&, i] { publish(participant, fmt::format("bench-{}", i), samples_per_s, over); });
  }
  threads.emplace_back([&] {
    char byte = 0;
    while (::read(STDIN_FILENO, &byte, 1) > 0) {
    }
    over = true;
  });
  while (!over) {
    bus::system_clock().wait(*bell, bus::system_clock().now() + 100ms);
    states.take([](const wire::ServiceStatus& status) {
      if (!status.recording().empty()) {
        fmt::print("stored {} {} {}\n", status.messages_stored(), status.messages_not_stored(),
                   status.recording());
        std::fflush(stdout);
      }
    });
  }
  return 0;
}
