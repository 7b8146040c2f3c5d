// The name of a run that nobody has named: the time, "20261122T101530.125Z". Any thread.
#pragma once

#include <cstdint>
#include <string>

namespace dyncal::inline contract {

[[nodiscard]] std::string time_name(std::int64_t utc_ns);
[[nodiscard]] bool is_time_name(const std::string& name);

} // namespace dyncal::inline contract
