// What all files say by their stamps and sample numbers: how regular stamps are, and that numbers
// rise.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::files {

// One clock for the whole block when its stamps are exactly equidistant and none is flagged.
void make_regular(SampleBlock& block);

// The sentence for a sample number that does not rise.
[[nodiscard]] std::string not_rising(std::uint64_t sample, std::uint64_t before);

} // namespace dyncal::drivers::files
