// The sources of all benches as the analysis knows them, within limits whatever is written on the
// bus.
//
// What is new beyond a limit takes the place of what was heard of longest ago and no living run
// uses; where all is in use, the new one is left out. A source describes itself once, so anyone who
// begins a run on a bench after something had no room has to read its sources again. Plain data,
// one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "services/bus/clock.hpp"
#include "services/contract/known_sources.hpp"

namespace dyncal::inline programs {

class KnownBenches {
public:
  using Instant = bus::Clock::Instant;

  static constexpr std::size_t max_benches = 64;
  static constexpr std::size_t max_sources = 32; // of a bench

  // Whether a living run uses something.
  struct InUse {
    std::function<bool(const std::string& bench)> bench;
    std::function<bool(const std::string& bench, const std::string& source)> source;
  };
  // What had no room, or was dropped for something new.
  struct LeftOut {
    std::uint64_t benches = 0;
    std::uint64_t sources = 0;
  };

  explicit KnownBenches(InUse in_use) : in_use_(std::move(in_use)) {}

  // Of which something has just come; null if it has no room.
  [[nodiscard]] KnownSource* heard(const std::string& bench, const std::string& source,
                                   Instant now);
  [[nodiscard]] const KnownSources& sources_of(const std::string& bench) const;
  [[nodiscard]] const LeftOut& left_out() const { return left_out_; }
  [[nodiscard]] std::size_t benches() const { return benches_.size(); }
  [[nodiscard]] std::size_t sources() const; // of all benches

private:
  struct KnownBench {
    KnownSources sources;
    std::map<std::string, Instant> heard; // of each
    Instant newest{};
  };

  [[nodiscard]] KnownBench* bench_of(const std::string& name);
  [[nodiscard]] bool has_room_for(const std::string& source, const std::string& bench,
                                  KnownBench& known);

  InUse in_use_;
  std::map<std::string, KnownBench> benches_;
  LeftOut left_out_;
};

} // namespace dyncal::inline programs
