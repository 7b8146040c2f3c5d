// Counts what is missing in the streams of sample blocks, by the numbers the blocks carry; DDS
// itself does not tell reliably.
//
// A source numbers its blocks from 0 in each session, empty ones too, and its samples without a
// break; a sample that was lost before it reached the bus shows as a jump of the sample number
// between two blocks that follow each other. So:
//   a jump of the block number   blocks were lost on the bus, with the samples in them
//   a jump of the sample number  samples are missing, wherever they were lost
// The first block heard of a source counts nothing as missing: who joins late has not lost what
// went before.
//
// One thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "idl/dyncal.h"

namespace dyncal::bus {

// What one block says about those before it.
struct ContinuityFinding {
  bool first = false;       // of this source
  bool new_session = false; // the source, or its device, has started anew: its stamps and numbers
                            // have no relation to those before
  bool duplicate = false;   // its number was there already, or it comes too late: do not use it
  std::uint64_t missing_blocks = 0;
  std::uint64_t missing_samples =
      0; // between the last sample before and its first; not known across sessions
  std::uint64_t repeated_samples =
      0; // at its beginning, with numbers that were there already: the source is at fault

  [[nodiscard]] bool continuous() const {
    return !new_session && !duplicate && missing_blocks == 0 && missing_samples == 0 &&
           repeated_samples == 0;
  }
};

// Of one source since the first block heard.
struct ContinuityCounts {
  std::uint64_t sessions = 0;
  std::uint64_t blocks = 0;  // without duplicates
  std::uint64_t samples = 0; // in them
  std::uint64_t missing_blocks = 0;
  std::uint64_t missing_samples = 0;
  std::uint64_t repeated_samples = 0;
  std::uint64_t duplicates = 0;
};

class SampleContinuity {
public:
  ContinuityFinding add(const wire::SampleBlock& block);

  // Zeros for a source never heard.
  [[nodiscard]] ContinuityCounts counts(const std::string& bench, const std::string& source) const;

private:
  struct Stream {
    std::uint64_t session = 0;
    std::uint64_t next_block = 0;
    std::uint64_t next_sample = 0;
    bool sample_known = false; // a block with samples has come in this session
    ContinuityCounts counts;
  };

  static void count_samples(Stream& stream, const wire::SampleBlock& block,
                            ContinuityFinding& finding);

  std::map<std::pair<std::string, std::string>, Stream> streams_;
};

} // namespace dyncal::bus
