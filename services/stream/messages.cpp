#include "services/stream/messages.hpp"

#include <unistd.h>

#include <utility>

#include "services/bus/host_network.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/source_kind.hpp"

namespace dyncal::inline stream {

dyncal::wire::SourceDescription to_message(const SourceOptions& source, std::uint64_t session,
                                           const std::string& software,
                                           const drivers::SourceDescription& description) {
  dyncal::wire::SourceDescription message = contract::to_message(description);
  message.bench(source.bench);
  message.source(source.source);
  message.session(session);
  message.kind(to_wire(source.kind));
  message.software(software);
  message.host(bus::host_name());
  message.process_id(static_cast<std::uint32_t>(getpid()));
  message.bench_file_sha256(source.origin.sha256);
  message.settings(source.origin.settings);
  message.contract_version(dyncal::wire::CONTRACT_VERSION);
  return message;
}

dyncal::wire::SampleBlock to_message(const SourceOptions& source, std::uint64_t session,
                                     std::uint64_t block_number, drivers::SampleBlock block) {
  dyncal::wire::SampleBlock message;
  message.bench(source.bench);
  message.source(source.source);
  message.session(session);
  message.block(block_number);
  message.first_sample(block.first_sample);
  message.sample_count(static_cast<std::uint32_t>(block.samples));
  message.channel_count(
      block.samples == 0 ? 0 : static_cast<std::uint32_t>(block.values.size() / block.samples));
  if (block.clock) {
    message.origin_ns(block.clock->origin_ns);
    message.interval_numerator_ns(block.clock->interval_numerator_ns);
    message.interval_denominator(block.clock->interval_denominator);
  }
  message.stamps_ns(std::move(block.stamps_ns));
  message.stamp_uncertainty_ns(std::move(block.stamp_uncertainty_ns));
  message.stamp_flags(std::move(block.flags));
  message.values(std::move(block.values));
  message.received_utc_ns(block.received_utc_ns);
  return message;
}

dyncal::wire::TriggeredRecord to_message(const SourceOptions& source, std::uint64_t session,
                                         const Shot& shot, drivers::SampleBlock block) {
  dyncal::wire::TriggeredRecord message;
  message.bench(source.bench);
  message.source(source.source);
  message.session(session);
  message.shot(shot.number);
  message.sample_count(static_cast<std::uint32_t>(block.samples));
  message.channel_count(
      block.samples == 0 ? 0 : static_cast<std::uint32_t>(block.values.size() / block.samples));
  message.trigger_utc_ns(shot.trigger_utc_ns);
  message.first_sample_s(shot.first_sample_s);
  message.interval_s(shot.interval_s);
  message.values(std::move(block.values));
  message.received_utc_ns(block.received_utc_ns);
  message.run(shot.run);
  message.step(shot.step);
  message.attempt(shot.attempt);
  return message;
}

dyncal::wire::SourceStatus to_message(const SourceOptions& source,
                                      const SourcePublisher::Snapshot& snapshot) {
  const drivers::SampleCounts& counts = snapshot.counts;
  dyncal::wire::SourceStatus message;
  message.bench(source.bench);
  message.source(source.source);
  message.session(snapshot.session);
  message.received(counts.received);
  message.lost_in_device(counts.lost_in_device);
  message.lost_in_transit(counts.lost_on_way);
  message.duplicates(counts.duplicates);
  message.rejected(counts.rejected);
  message.stamps_not_trusted(counts.stamps_not_trusted);
  for (const drivers::NamedCount& cause : counts.causes) {
    dyncal::wire::NamedCount count;
    count.name(cause.name);
    count.value(cause.value);
    message.causes().push_back(std::move(count));
  }
  message.clock_uncertainty_s(counts.clock_uncertainty_s);
  message.message(snapshot.message);
  return message;
}

} // namespace dyncal::inline stream
