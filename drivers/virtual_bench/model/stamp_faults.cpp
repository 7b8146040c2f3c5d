#include "drivers/virtual_bench/model/stamp_faults.hpp"

#include <cmath>

#include "drivers/virtual_bench/model/dau_clock.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

std::int64_t ticks_in_ns(double ticks) {
  return std::llround(ticks / DauClock::nominal_hz * 1e9);
}

} // namespace

const std::vector<std::string>& stamp_fault_names() {
  static const std::vector<std::string> names{"second-slip", "counter-extension", "torn-counter",
                                              "pps-offset",  "repeated",          "no-uncertainty",
                                              "no-fix",      "unit-loss"};
  return names;
}

StampFaults::StampFaults(std::uint64_t seed, StampFaultProbabilities probabilities)
    : random_(seed, "stamp faults"), probabilities_(std::move(probabilities)) {}

bool StampFaults::happens(const char* name) {
  const auto found = probabilities_.find(name);
  return found != probabilities_.end() && random_.happens(found->second);
}

bool StampFaults::apply(UnitSample& sample) {
  const std::int64_t right_ns = sample.utc_ns;
  if (happens("unit-loss")) {
    return false;
  }
  if (right_ns >= episode_end_ns_) {
    offset_ns_ = 0;
    if (happens("second-slip")) {
      offset_ns_ = random_.happens(0.5) ? second_ns : -second_ns;
    } else if (happens("pps-offset")) {
      offset_ns_ = std::llround(random_.uniform(1e5, 9e8));
    }
    if (offset_ns_ != 0) {
      episode_end_ns_ = right_ns + std::llround(random_.uniform(0.05, 1.0) * 1e9);
    }
  }
  sample.utc_ns += offset_ns_;
  if (happens("counter-extension")) {
    sample.utc_ns += ticks_in_ns(4294967296.0);
  }
  if (happens("torn-counter")) {
    sample.utc_ns += (random_.happens(0.5) ? 1 : -1) * ticks_in_ns(65536.0);
  }
  if (previous_ns_ != 0 && happens("repeated")) {
    sample.utc_ns = previous_ns_;
    sample.uncertainty_ns = 0x2c;
  }
  if (happens("no-uncertainty")) {
    sample.uncertainty_ns = 0;
  }
  if (happens("no-fix")) {
    sample.utc_ns = 0;
  }
  previous_ns_ = sample.utc_ns;
  return true;
}

} // namespace dyncal::drivers::virtual_bench
