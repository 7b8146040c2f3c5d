#include "services/contract/sample_continuity.hpp"

#include <algorithm>

namespace dyncal::bus {

ContinuityFinding SampleContinuity::add(const wire::SampleBlock& block) {
  const auto [position, inserted] =
      streams_.try_emplace({block.bench().to_string(), block.source().to_string()});
  Stream& stream = position->second;

  ContinuityFinding finding;
  finding.first = inserted;
  if (inserted || block.session() != stream.session) {
    finding.new_session = !inserted;
    stream.session = block.session();
    stream.sample_known = false;
    // A session begins with block 0; only who heard the source before can have missed its
    // beginning.
    stream.next_block = inserted ? block.block() : 0;
    ++stream.counts.sessions;
  }

  if (block.block() < stream.next_block) {
    finding.duplicate = true;
    ++stream.counts.duplicates;
    return finding;
  }
  finding.missing_blocks = block.block() - stream.next_block;
  stream.next_block = block.block() + 1;
  stream.counts.missing_blocks += finding.missing_blocks;
  ++stream.counts.blocks;
  if (block.sample_count() > 0) {
    count_samples(stream, block, finding);
  }
  return finding;
}

void SampleContinuity::count_samples(Stream& stream, const wire::SampleBlock& block,
                                     ContinuityFinding& finding) {
  const std::uint64_t begin = block.first_sample();
  const std::uint64_t end = begin + block.sample_count();
  if (stream.sample_known && begin > stream.next_sample) {
    finding.missing_samples = begin - stream.next_sample;
  }
  if (stream.sample_known && begin < stream.next_sample) {
    finding.repeated_samples = std::min(end, stream.next_sample) - begin;
  }
  stream.next_sample = stream.sample_known ? std::max(end, stream.next_sample) : end;
  stream.sample_known = true;
  stream.counts.samples += block.sample_count();
  stream.counts.missing_samples += finding.missing_samples;
  stream.counts.repeated_samples += finding.repeated_samples;
}

ContinuityCounts SampleContinuity::counts(const std::string& bench,
                                          const std::string& source) const {
  const auto stream = streams_.find({bench, source});
  return stream == streams_.end() ? ContinuityCounts{} : stream->second.counts;
}

} // namespace dyncal::bus
