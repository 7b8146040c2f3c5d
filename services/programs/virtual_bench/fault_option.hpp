// One --fault of the command line, NAME=VALUE[,KEY=VALUE...], into the description of what is wrong
// with the bench (drivers/virtual_bench/model/bench_faults.hpp).
//
//   over-range=LIMIT,at=CHANNEL        end stops at +-LIMIT in m/s^2 or V
//   soft-ends=LIMIT,at=CHANNEL         likewise, before noise and converter; end=upper or end=lower
//   held=PART,at=CHANNEL               of the samples have the value of the one before
//   fifo=SAMPLES                       of the sensor are read at once, with stamps 10 ns apart
//   stuck=SAMPLES,at=CHANNEL           for so many samples, every second, or every=SECONDS
//   hum=PART,at=CHANNEL                of the signal, at 50 Hz, or frequency=HZ; while=driven: only
//                                      while the generator's output is on
//   drift=PART,at=CHANNEL              of the signal per second, from each change of the generator
//   loss=PROBABILITY,at=sensor|acs     per sample, or per frame of the ACS; counted=no: the numbers
//                                      of the samples do not show it
//   free-running                       the time series sensor starts with its next own sample
//   start-jitter=SECONDS               standard deviation of its start from shot to shot
//   exciter-gain=FACTOR                times the acceleration that a volt should give
//   ring-down=SECONDS                  time constant of the exciter after a step, 0.04 as a rule
//   generator-offset=VOLTS             DC offset that another program left
//   generator-burst                    likewise its burst
//   generator-no-reset                 resets of what was left are taken, and it is kept
//   output-stays-on                    once on, although the generator answers that it is off
//   NAME=PROBABILITY                   per sample, of a stamp (stamp_faults.hpp)
//
// CHANNEL is sensor, reference, sync_acs or sync_dau. Fails (bad_argument) with the whole option.
// Any thread.
#pragma once

#include <string>

#include "drivers/virtual_bench/model/bench_faults.hpp"
#include "services/base/error.hpp"

namespace dyncal::inline programs::virtual_bench {

[[nodiscard]] Expected<void> read_fault(const std::string& text,
                                        drivers::virtual_bench::BenchFaults& faults);

// What can be written, for --help.
[[nodiscard]] std::string fault_help();

} // namespace dyncal::inline programs::virtual_bench
