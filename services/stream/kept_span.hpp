// How much of a source fits into what it may keep for who was away (retransmission_buffer.hpp),
// told before anything is dropped.
//
// Each sample takes 8 bytes a channel, and 13 for its stamp where samples have stamps of their own
// (all but the ACS's); the few bytes of a block beside them are left out. Pure function, any
// thread.
#pragma once

#include <optional>
#include <string>

#include "drivers/sample_block.hpp"
#include "services/contract/source_kind.hpp"
#include "services/stream/retransmission_buffer.hpp"

namespace dyncal::inline stream {

struct KeptSpan {
  double minutes = 0.0;
  bool is_short = false; // less than the limits promise
  std::string sentence;
};

// Nothing where the rate is not known, or shots decide it.
[[nodiscard]] std::optional<KeptSpan>
kept_span(SourceKind kind, const drivers::SourceDescription& source, const KeptLimits& limits);

} // namespace dyncal::inline stream
