#include "services/contract/sample_continuity.hpp"

#include <algorithm>

namespace dyncal::inline contract {

void SampleContinuity::begin_session(const SourceBlock& block, ContinuityFinding& finding) {
  finding.first = !heard_;
  finding.new_session = heard_;
  // A session begins with block 0; only who heard the source before can have missed its beginning.
  next_block_ = heard_ ? 0 : block.number;
  session_ = block.session;
  heard_ = true;
  sample_known_ = false;
  pending_samples_ = 0;
  ++counts_.sessions;
}

ContinuityFinding SampleContinuity::add(const SourceBlock& block, BlockUse use) {
  ContinuityFinding finding;
  if (!heard_ || block.session != session_) {
    begin_session(block, finding);
  }
  if (block.number < next_block_) {
    finding.duplicate = true;
    ++counts_.duplicates;
    return finding;
  }
  finding.missing_blocks = block.number - next_block_;
  next_block_ = block.number + 1;
  counts_.missing_blocks += finding.missing_blocks;
  ++counts_.blocks;
  if (use == BlockUse::unusable) {
    ++counts_.unusable_blocks;
    pending_samples_ += block.samples;
  } else if (block.samples > 0) {
    count_samples(block, finding);
  }
  return finding;
}

void SampleContinuity::count_samples(const SourceBlock& block, ContinuityFinding& finding) {
  const std::uint64_t begin = block.first_sample;
  const std::uint64_t end = begin + block.samples;
  if (!sample_known_) {
    finding.missing_samples = pending_samples_; // no number before them tells better
  } else if (begin > next_sample_) {
    finding.missing_samples = begin - next_sample_;
  } else {
    finding.repeated_samples = std::min(end, next_sample_) - begin;
  }
  finding.unusable_samples = std::min(pending_samples_, finding.missing_samples);
  next_sample_ = sample_known_ ? std::max(end, next_sample_) : end;
  sample_known_ = true;
  pending_samples_ = 0;
  counts_.samples += block.samples;
  counts_.missing_samples += finding.missing_samples;
  counts_.unusable_samples += finding.unusable_samples;
  counts_.repeated_samples += finding.repeated_samples;
}

} // namespace dyncal::inline contract
