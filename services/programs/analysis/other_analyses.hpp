// What other analysis services do, by their ServiceStatus: which of them leads a run.
//
// One service leads a run and publishes about it; the others stand by and take it over when nothing
// was heard of the leader for `silence_limit`. Where two have begun the same run, the one that has
// armed it leads, else the one whose name sorts first; both come to the same decision. Plain data,
// one thread; the newest `max_runs` are remembered, and those that are in use stay.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"

namespace dyncal::inline programs {

using RunKey = std::pair<std::string, std::string>; // bench, run

class OtherAnalyses {
public:
  using Instant = bus::Clock::Instant;

  static constexpr std::chrono::seconds silence_limit{4}; // a status comes every second
  static constexpr std::size_t max_runs = 1000;

  struct Leader {
    std::string service;
    std::string software;
    wire::ArmState arm = wire::ARM_WAITING;
    Instant heard;
  };

  using InUse = std::function<bool(const RunKey&)>;

  // `in_use`: of runs that this service serves, or follows as they go on.
  OtherAnalyses(std::string own_service, InUse in_use)
      : own_service_(std::move(own_service)), in_use_(std::move(in_use)) {}

  void add(const wire::ServiceStatus& status, Instant now);
  // The service of which a status of this run was heard last; nothing if there was none.
  [[nodiscard]] std::optional<Leader> last_leader(const RunKey& run) const;
  // The same, within `silence_limit`.
  [[nodiscard]] std::optional<Leader> leader(const RunKey& run, Instant now) const;
  // Whether another service leads a run that this one has begun, too.
  [[nodiscard]] bool must_give_way(const RunKey& run, bool armed, Instant now) const;
  // Runs that had no room, or were dropped although their leader had not been silent for long.
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

private:
  bool make_room(Instant now);

  std::string own_service_;
  InUse in_use_;
  std::uint64_t left_out_ = 0;
  std::map<RunKey, Leader> leaders_;
};

} // namespace dyncal::inline programs
