// Which software this is: for results, which carry it, and for `--version` of every program.
//
// The commit is that of the checkout at build time, with "-dirty" if files differed from it; a
// build outside a checkout has none. Any thread.
#pragma once

#include <string>

namespace dyncal::inline base {

// As results and descriptions carry it: "dyncal 0.2.0 (1a2b3c4)".
[[nodiscard]] std::string software_version();

// As `--version` prints it, in lines: software_version(), the DDS implementations of this build
// with the versions it was built with, the compiler and the build type.
[[nodiscard]] std::string build_description();

} // namespace dyncal::inline base
