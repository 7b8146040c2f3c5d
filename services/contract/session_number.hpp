// The number of a source's session: random, so that two sessions of one source are never taken for
// one, whichever host or process began them. Any thread.
#pragma once

#include <cstdint>

namespace dyncal::inline contract {

// Never 0.
[[nodiscard]] std::uint64_t random_session();

} // namespace dyncal::inline contract
