// Whether Cyclone DDS can have the threads that it makes for a domain. Version 0.10.5 ends the
// program where it gets one of them not; by then those that it had are gone, so that nobody can see
// any more what was missing. Any thread.
#pragma once

#include "services/base/error.hpp"

namespace dyncal::bus {

// Makes as many at once, and ends them. Fails (network) with what to raise.
[[nodiscard]] base::Expected<void> check_threads_for_cyclone_dds();

} // namespace dyncal::bus
