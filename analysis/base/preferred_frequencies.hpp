// The preferred frequencies of ISO 266 in a range, as people ask for them: "third-octave 10..200".
//
// Third octaves have the nominal values 1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3 and 8 in each decade;
// octaves are every third of them, counted from 1000 Hz. Both ends belong to the range. Any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::analysis {

// In Hz, ascending, as the decimal text that Frequency::parse() takes. Nothing where the text is
// not "third-octave A..B" or "octave A..B" with 0.01 <= A <= B <= 1e6; empty: none lies there.
[[nodiscard]] std::optional<std::vector<std::string>> preferred_frequencies(std::string_view text);

} // namespace dyncal::analysis
