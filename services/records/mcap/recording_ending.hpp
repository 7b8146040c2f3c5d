// How a recording ends behind DataEnd. Summary, Footer and magic, all of them sound, come from a
// program that ended in order; Footer and magic alone from one that was killed. Fails as reading
// does. Plain function, any thread.
#pragma once

#include <cstdint>

#include "services/records/mcap/recording_reader.hpp"

namespace dyncal::inline records::recording {

enum class Ending { damaged, without_summary, with_summary };

// `begin`: behind DataEnd.
[[nodiscard]] base::Expected<Ending> ending_behind(const RecordingReader& reader,
                                                   std::uint64_t begin);

} // namespace dyncal::inline records::recording
