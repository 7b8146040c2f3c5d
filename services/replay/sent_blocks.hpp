// When the blocks of one source were sent, by the recorder's clock, to tell what stamp its samples
// had when something else was recorded: so the evaluation learns in the clock of every source when
// a step was over, although a source begins late, lacks a part, or was recorded late.
//
// Of the session that was handed over last, in its order. A block's stamp is that of its last
// sample. Between two blocks that follow each other the stamp is interpolated; where blocks are
// missing it is just behind the block before, and before the first block just before that.
//
// Units: ns. 16 bytes a block. Belongs to one thread; does not fail.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/contract/source_block.hpp"
#include "services/evaluation/record/announced_instants.hpp"

namespace dyncal::services {

class SentBlocks {
public:
  void add(const SourceBlock& block, std::int64_t sent_ns);
  // Nothing before the first block with samples.
  [[nodiscard]] std::optional<SourceInstant> at(std::int64_t recorded_ns) const;

private:
  struct Sent {
    std::int64_t sent_ns; // not before that of the block before: the clock of a host may step back
    std::int64_t last_ns;
    std::uint64_t number;
  };

  std::uint64_t session_ = 0;
  std::int64_t first_ns_ = 0;
  std::vector<Sent> blocks_;
};

} // namespace dyncal::services
