// Since which CONTRACT_VERSION of a program (idl/README.md, "How the contract grows") it does what
// others go by. Constants, any thread.
#pragma once

#include <cstdint>

namespace dyncal::inline contract::contract_versions {

// An analysis writes its status and the results of a run in the partition of that run, too; before,
// in that of the bench alone.
inline constexpr std::uint32_t partitions_of_runs = 2;

} // namespace dyncal::inline contract::contract_versions
