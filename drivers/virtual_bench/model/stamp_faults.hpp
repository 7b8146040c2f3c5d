// What goes wrong with the time stamps of a SmartUp Unit, each with a probability per sample:
//
//   second-slip        a second mislabelled: exactly +1 or -1 s for up to a second, then back
//   counter-extension  one sample 2^32 ticks (39.768 s) late
//   torn-counter       one sample 2^16 ticks (606.8 us) off: the halves of the counter were read at
//                      different times
//   pps-offset         an extra edge of the pulse per second: off by less than a second, for up to
//                      a second
//   repeated           the time of the sample before, with a tiny uncertainty: the conversion was
//                      skipped
//   no-uncertainty     uncertainty 0: the unit does not trust its clock
//   no-fix             time 0: no GPS fix
//   unit-loss          the sample is lost in the unit; its number is used up
//
// One thread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drivers/virtual_bench/model/random.hpp"
#include "drivers/virtual_bench/model/unit_sample.hpp"

namespace dyncal::drivers::virtual_bench {

using StampFaultProbabilities = std::map<std::string, double>;

[[nodiscard]] const std::vector<std::string>& stamp_fault_names();

class StampFaults {
public:
  StampFaults(std::uint64_t seed, StampFaultProbabilities probabilities);

  // Spoils the stamp of a sample. False: the sample is lost in the unit.
  [[nodiscard]] bool apply(UnitSample& sample);

private:
  [[nodiscard]] bool happens(const char* name);

  Random random_;
  StampFaultProbabilities probabilities_;
  std::int64_t offset_ns_ = 0; // of the episode that lasts until episode_end_ns_
  std::int64_t episode_end_ns_ = 0;
  std::int64_t previous_ns_ = 0;
};

} // namespace dyncal::drivers::virtual_bench
