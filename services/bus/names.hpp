// Names of benches, sources, runs and channels on the bus: keys of bounded length, and the bench is
// the DDS partition as well. What an analysis says of one run is in a partition of that run, too.
//
// Check a name where a user gives it. The key members of the contract's structs truncate a longer
// text silently, and two long names could become one.
#pragma once

#include <cstddef>
#include <string>

#include "services/base/error.hpp"

namespace dyncal::bus {

inline constexpr std::size_t max_name = 64;     // characters of bench, source, run, service, target
inline constexpr std::size_t max_channel = 128; // characters of "source/channel"
inline constexpr std::size_t max_asker = 128;   // characters of who catches up

// Fails (bad_argument) when the name is empty or too long. `what` begins the sentence: "the bench",
// "source".
[[nodiscard]] base::Expected<void> check_name(const std::string& what, const std::string& name,
                                              std::size_t longest = max_name);

// A name that one bench can have: as above, and without the characters that make a DDS partition a
// pattern (* ? [ ]).
[[nodiscard]] base::Expected<void> check_bench_name(const std::string& name);

// The name of who catches up, which is a partition as well: likewise, but it may be longer.
[[nodiscard]] base::Expected<void> check_asker_name(const std::string& name);

// The partition of one run: the bench, "/", and the run with _ in place of * ? [ ].
[[nodiscard]] std::string partition_of_run(const std::string& bench, std::string run);

} // namespace dyncal::bus
