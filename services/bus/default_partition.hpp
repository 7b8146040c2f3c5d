// The default partition, the one without a name: where other tools read that have no partitions, or
// whose user names none.
//
// A writer of results or state is there as well as in its bench, so that such a tool sees them. A
// writer of samples is there only where the program was asked for it, since each reader costs the
// source packets. Nothing of a secured laboratory is: its permissions name the benches. dyncal's
// own readers ask for a bench, a run, or "*": each of them matches such a writer once, and takes
// each message once.
#pragma once

#include <string>
#include <vector>

#include "services/bus/bus.hpp"

namespace dyncal::bus {

// Those that a writer gets which was asked for in `partitions`, in their order.
[[nodiscard]] std::vector<std::string> partitions_of_writer(Profile profile, bool secured,
                                                            std::vector<std::string> partitions);

// Whether every writer of samples or records that this process makes from now on is there, too
// (not unless this is called). Any thread.
void publish_samples_in_default_partition(bool wanted);

} // namespace dyncal::bus
