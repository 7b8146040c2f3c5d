#include "services/contract/source_block.hpp"

#include "idl/dyncal.h"

namespace dyncal::inline contract {

bool SourceBlock::is_consistent() const {
  const bool stamped = stamps_ns.empty()
                           ? clock.interval_numerator_ns > 0 && clock.interval_denominator > 0
                           : stamps_ns.size() == samples;
  const bool flagged = flags.empty() || flags.size() == samples;
  return stamped && flagged && channels > 0 && values.size() == samples * channels;
}

SourceBlock view_block(const wire::SampleBlock& message) {
  return {.session = message.session(),
          .number = message.block(),
          .first_sample = message.first_sample(),
          .samples = message.sample_count(),
          .channels = message.channel_count(),
          .end_of_stream = message.end_of_stream(),
          .clock = {message.origin_ns(), message.interval_numerator_ns(),
                    message.interval_denominator()},
          .stamps_ns = message.stamps_ns(),
          .stamp_uncertainty_ns = message.stamp_uncertainty_ns(),
          .flags = message.stamp_flags(),
          .values = message.values()};
}

SourceBlock view_block(const drivers::SampleBlock& block, std::uint64_t session,
                       std::uint64_t number) {
  return {.session = session,
          .number = number,
          .first_sample = block.first_sample,
          .samples = block.samples,
          .channels = block.samples == 0 ? 0 : block.values.size() / block.samples,
          .clock = block.clock.value_or(drivers::RegularClock{0, 0, 0}),
          .stamps_ns = block.stamps_ns,
          .stamp_uncertainty_ns = block.stamp_uncertainty_ns,
          .flags = block.flags,
          .values = block.values};
}

} // namespace dyncal::inline contract
