// How long a test waits for what must happen: longer than it takes on two busy processors with a
// sanitizer. A deadline that is not reached costs nothing. Tests of how soon something happens have
// times of their own, stepped where they can be.
#pragma once

#include <chrono>

namespace dyncal::tests {

inline constexpr std::chrono::seconds patience{300};

} // namespace dyncal::tests
