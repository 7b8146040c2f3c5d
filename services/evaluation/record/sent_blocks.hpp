// When the blocks of one source were sent, by the clock of whoever heard them, to tell what stamp
// its samples had when something else was heard: so the evaluation knows in the clock of every
// source when a step was over, although a source begins late, lacks a part, or its samples are
// late.
//
// Of the newest session, in the order of its blocks. The block of all that was heard soonest tells
// how far the clocks of the two hosts are apart; a clock that is set makes stamps later than they
// were, never earlier. A block's stamp is that of its last sample. Between two blocks that follow
// each other the stamp is interpolated; where blocks are missing it is just behind the block
// before, and before the first block just before that.
//
// Units: ns. Holds the newest `max_blocks`. Belongs to one thread; does not fail.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>

#include "services/contract/source_block.hpp"

namespace dyncal::inline evaluation {

struct BlockTimes {
  std::int64_t sent_ns = 0;  // by the clock of the source's host
  std::int64_t heard_ns = 0; // by that of whoever heard it
};

// Of what was heard in the clock of a source.
struct SourceInstant {
  std::int64_t stamp_ns = 0;
  bool is_between_samples = true; // that follow each other
};

class SentBlocks {
public:
  static constexpr std::size_t max_blocks = std::size_t{1} << 17U; // an hour of blocks of 20 ms

  void add(const SourceBlock& block, const BlockTimes& times);
  // Nothing before the first block with samples.
  [[nodiscard]] std::optional<SourceInstant> at(std::int64_t heard_ns) const;

private:
  struct Sent {
    std::int64_t
        sent_ns; // not before that of the block before: the clock of a host may be set back
    std::int64_t last_ns;
    std::uint64_t number;
  };

  std::uint64_t session_ = 0;
  std::int64_t first_ns_ = 0;
  std::int64_t min_delay_ns_ = std::numeric_limits<std::int64_t>::max();
  std::deque<Sent> blocks_;
};

} // namespace dyncal::inline evaluation
