// The topic on which a source of a kind publishes its samples: blocks, or triggered records. Any
// thread.
#pragma once

#include "idl/dyncal.h"

namespace dyncal::bus {

[[nodiscard]] const char* sample_topic(wire::SourceKind kind);

// Whether a source of this kind sends a TriggeredRecord for every shot; else it sends SampleBlocks
// all the time.
[[nodiscard]] bool is_triggered(wire::SourceKind kind);

} // namespace dyncal::bus
