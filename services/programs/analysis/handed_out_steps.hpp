// The steps that a system which evaluates itself hands out during a run (topic AcsStep), as they
// come. The topic keeps them: who begins behind the run has those from before as well. Belongs to
// the run's one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "idl/dyncal.h"
#include "services/bus/bus.hpp"

namespace dyncal::inline programs {

class HandedOutSteps {
public:
  using Take = std::function<bool(const wire::AcsStep&, const bus::WriterId&)>;

  // Fails as readers do.
  [[nodiscard]] static Expected<HandedOutSteps> open(bus::Participant& participant,
                                                     const std::shared_ptr<bus::WakeUp>& wake_up,
                                                     std::string bench, std::string run,
                                                     std::string source);

  [[nodiscard]] const std::string& source() const { return source_; }
  // Those of this run and source that have come; counted are those that `take` accepts.
  void take(const Take& take);
  // How many steps have come.
  [[nodiscard]] std::size_t count() const { return steps_.size(); }
  // A sentence about those of `planned` that have not; empty: all have.
  [[nodiscard]] std::string missing(std::size_t planned) const;

private:
  HandedOutSteps(bus::Reader<wire::AcsStep> reader, std::string bench, std::string run,
                 std::string source)
      : reader_(std::move(reader)), bench_(std::move(bench)), run_(std::move(run)),
        source_(std::move(source)) {}

  bus::Reader<wire::AcsStep> reader_;
  std::string bench_;
  std::string run_;
  std::string source_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> steps_; // with their repetition
};

} // namespace dyncal::inline programs
