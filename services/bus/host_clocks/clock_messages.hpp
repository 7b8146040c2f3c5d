// Who takes part in the exchange of clocks, and where on the bus it happens. Plain data.
#pragma once

#include <string>

#include "idl/dyncal.h"
#include "services/contract/program_identity.hpp"

namespace dyncal::inline host_clocks {

// Partition and `bench` of requests and answers: they are of no single bench.
inline constexpr const char* all_benches_partition = "all-benches";

// The same in every message of the process: "dyncal-acs:4711@lab-2", cut where a key ends.
[[nodiscard]] std::string service_name(const ProgramIdentity& identity);

// This process.
[[nodiscard]] ProgramIdentity this_program(const std::string& program, const std::string& software,
                                           const std::string& dds);

[[nodiscard]] ProgramIdentity identity_of(const wire::ClockAnswer& answer);

} // namespace dyncal::inline host_clocks
