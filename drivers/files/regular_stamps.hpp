// What all files say by their stamps and sample numbers: how regular they are, and that they rise.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::files {

// One clock for the whole block when its stamps are exactly equidistant.
void make_regular(SampleBlock& block);

// The sentence for a stamp or a sample number that does not rise.
[[nodiscard]] std::string not_rising(std::int64_t stamp_ns, std::int64_t before_ns);
[[nodiscard]] std::string not_rising(std::uint64_t sample, std::uint64_t before);

} // namespace dyncal::drivers::files
