// Counts what is missing in the stream of one source, by the numbers its blocks carry; DDS itself
// does not tell reliably.
//
// A source numbers its blocks from 0 in each session, empty ones too, and its samples without a
// break; a sample that was lost before it reached the bus shows as a jump of the sample number
// between two blocks that follow each other. So:
//   a jump of the block number   blocks were lost on the bus, with the samples in them
//   a jump of the sample number  samples are missing, wherever they were lost
// The first block heard counts nothing as missing: who joins late has not lost what went before.
// A block that its receiver cannot use takes part in the numbering of blocks only, so that its
// samples are missing like those of a block that never came.
//
// One thread.
#pragma once

#include <cstdint>

#include "services/contract/source_block.hpp"

namespace dyncal::inline contract {

// What one block says about those before it.
struct ContinuityFinding {
  bool first = false;       // of this source
  bool new_session = false; // the source, or its device, has restarted: its stamps and numbers
                            // have no relation to those before
  bool duplicate = false;   // its number was there already, or it comes too late: do not use it
  std::uint64_t missing_blocks = 0;
  // Between the last sample before and its first; not known across sessions.
  std::uint64_t missing_samples = 0;
  std::uint64_t unusable_samples = 0; // of those missing, in blocks that could not be used
  // At its beginning, with numbers that were there already: the source is at fault.
  std::uint64_t repeated_samples = 0;

  [[nodiscard]] bool continuous() const {
    return !new_session && !duplicate && missing_blocks == 0 && missing_samples == 0 &&
           repeated_samples == 0;
  }
};

// Since the first block heard.
struct ContinuityCounts {
  std::uint64_t sessions = 0;
  std::uint64_t blocks = 0;  // without duplicates
  std::uint64_t samples = 0; // in them, where they could be used
  std::uint64_t missing_blocks = 0;
  std::uint64_t missing_samples = 0;
  std::uint64_t unusable_samples = 0; // of those missing
  std::uint64_t repeated_samples = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t unusable_blocks = 0;
};

enum class BlockUse { usable, unusable };

class SampleContinuity {
public:
  ContinuityFinding add(const SourceBlock& block, BlockUse use = BlockUse::usable);

  // Whether a block of this session would begin a new one.
  [[nodiscard]] bool is_new_session(std::uint64_t session) const {
    return heard_ && session != session_;
  }
  [[nodiscard]] const ContinuityCounts& counts() const { return counts_; }
  // In unusable blocks behind the last block that could be used, as far as these say how many: they
  // are in no ContinuityFinding yet.
  [[nodiscard]] std::uint64_t pending_samples() const { return pending_samples_; }

private:
  void begin_session(const SourceBlock& block, ContinuityFinding& finding);
  void count_samples(const SourceBlock& block, ContinuityFinding& finding);

  bool heard_ = false;
  std::uint64_t session_ = 0;
  std::uint64_t next_block_ = 0;
  std::uint64_t next_sample_ = 0;
  bool sample_known_ = false; // a usable block with samples has come in this session
  std::uint64_t pending_samples_ = 0;
  ContinuityCounts counts_;
};

} // namespace dyncal::inline contract
