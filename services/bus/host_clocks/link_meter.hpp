// Measures the path to every program of a laboratory and back: which part of small, numbered,
// best-effort probes brings an echo. DDS sends neither again, so what reliable topics hide is seen.
//
// Sends probes once a program answers about its clock, one every `interval`, and more slowly where
// many programs answer: each gets a packet of its own, and the link must not lose any because of
// the probes. Ends after `max_probes`. A probe that is late is not made up for: no bursts. One that
// is overtaken is lost to DDS, and counts as lost.
//
// One of `turns_of_long` is as long as a packet with samples: a way whose MTU is smaller drops
// those without a word, while all that is short goes on. They have a series of their own.
//
// A path counts from the first echo, for what was sent before two programs had found each other is
// no loss, up to the newest probe that had time to be echoed before the program last answered.
//
// Bound: echoes of `max_programs`. Belongs to one thread, which calls work() when the wake-up rings
// or next_probe() is due.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/clock.hpp"
#include "services/bus/host_clocks/clock_asker.hpp"

namespace dyncal::inline host_clocks {

struct LinkLoss {
  ProgramIdentity identity = {}; // of the other end
  bool answers_probes = false;   // otherwise nothing is known
  std::uint64_t sent = 0;
  std::uint64_t echoed = 0;
  std::uint64_t long_sent = 0; // beside those
  std::uint64_t long_echoed = 0;
};

// The fewest that a loss is stated of.
inline constexpr std::uint64_t fewest_probes = 20;

// 0 to 1; nothing where too few were sent. Plain function.
[[nodiscard]] std::optional<double> lost_part(const LinkLoss& loss);

// No long probe came back of those that a way would have let through that loses as many as it does
// of the short ones. Plain function.
[[nodiscard]] bool drops_long_packets(const LinkLoss& loss);

class LinkMeter {
public:
  using Instant = bus::Clock::Instant;
  static constexpr std::chrono::milliseconds interval{10};
  static constexpr std::chrono::milliseconds interval_per_program{2};
  static constexpr std::size_t max_probes = 2000;
  static constexpr std::size_t turns_of_long = 5;
  // With headers nearly 1400 bytes, in one packet of either implementation.
  static constexpr std::size_t padding_bytes = 1200;
  static constexpr std::size_t max_programs = 500;
  // From the first answer of a program until it also gets probes; on the way.
  static constexpr std::chrono::milliseconds settling{300};

  // Fails (network) as writers and readers do. `clock` outlives the object.
  [[nodiscard]] static Expected<LinkMeter> open(bus::Participant& participant,
                                                const ProgramIdentity& identity, bus::Clock& clock,
                                                const std::shared_ptr<bus::WakeUp>& wake_up);

  // Takes echoes, and sends a probe when it is time; `programs` answer about their clocks.
  void work(std::size_t programs);
  // The end of time before a program has answered, and after the last probe.
  [[nodiscard]] Instant next_probe() const { return next_probe_; }

  // One a program, in their order.
  [[nodiscard]] std::vector<LinkLoss> losses(const std::vector<DiscoveredProgram>& programs) const;
  [[nodiscard]] std::uint64_t probes() const { return short_.sent.size() + long_.sent.size(); }

private:
  struct Echoes {
    std::uint64_t first = 0; // numbers of the probes, from 1
    std::uint64_t newest = 0;
    std::uint64_t count = 0;
  };

  struct Series {
    std::uint64_t id = 0;
    std::vector<Instant> sent{};            // of each probe, the first first
    std::map<std::string, Echoes> echoes{}; // by program
  };
  struct Count {
    std::uint64_t sent = 0;
    std::uint64_t echoed = 0;
  };

  LinkMeter(std::string name, bus::Clock& clock, bus::Writer<wire::LinkProbe> probes,
            bus::Reader<wire::LinkEcho> echoes);
  void take(const wire::LinkEcho& echo);
  void send(Series& series, std::size_t padding);
  [[nodiscard]] static Count count_of(const Series& series, const DiscoveredProgram& program);
  [[nodiscard]] LinkLoss loss(const DiscoveredProgram& program) const;

  std::string name_;
  bus::Clock* clock_;
  bus::Writer<wire::LinkProbe> probes_;
  bus::Reader<wire::LinkEcho> echoes_;
  Series short_;
  Series long_;
  Instant next_probe_ = Instant::max();
  std::size_t turn_ = 0;
};

} // namespace dyncal::inline host_clocks
