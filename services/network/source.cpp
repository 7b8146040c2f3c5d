#include "services/network/source.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/printable_text.hpp"
#include "services/contract/known_sources.hpp"
#include "services/contract/source_description.hpp"

namespace dyncal::network {
namespace {

SourceState state_of(wire::SourceState state) {
  return per_enumerator(state,
                        {SourceState::starting, SourceState::running, SourceState::silent,
                         SourceState::ended, SourceState::failed},
                        SourceState::unknown);
}

} // namespace

const char* to_string(SourceState state) {
  return per_enumerator(state, {"unknown", "starting", "running", "silent", "ended", "failed"});
}

void Source::take(const wire::SourceDescription& described, const Limits& limits) {
  session = described.session();
  kind = from_wire(described.kind());
  description = from_message(described);
  software = one_line(described.software());
  host = one_line(described.host());
  process_id = described.process_id();
  contract_version = described.contract_version();
  bench_file.sha256 = one_line(described.bench_file_sha256());
  bench_file.settings =
      described.settings().size() > limits.settings_bytes ? std::string() : described.settings();
  if (const std::string service = one_line(service_of(described));
      !service.empty() && services.size() < limits.services) {
    services.insert(service);
  }
  auto& channels = description->channels;
  channels.resize(std::min(channels.size(), limits.channels));
  for (drivers::ChannelDescription& channel : channels) {
    channel.name = one_line(channel.name);
    channel.quantity = one_line(channel.quantity);
    channel.unit = one_line(channel.unit);
  }
  for (std::string* text :
       {&description->device, &description->serial, &description->firmware, &description->driver}) {
    *text = one_line(*text);
  }
}

void Source::take(const wire::SourceStatus& status, const Limits& limits, Instant now) {
  const bool continues = counted_session == status.session();
  const std::uint64_t lost_before = lost();
  session = status.session();
  counted_session = session;
  turns.add(session);
  state = state_of(status.state());
  rate_hz = status.rate_hz();
  counts = {.received = status.received(),
            .lost_in_device = status.lost_in_device(),
            .lost_on_way = status.lost_in_transit(),
            .duplicates = status.duplicates(),
            .rejected = status.rejected(),
            .stamps_not_trusted = status.stamps_not_trusted(),
            .causes = {},
            .clock_uncertainty_s = status.clock_uncertainty_s()};
  for (const wire::NamedCount& cause : status.causes()) {
    if (counts.causes.size() < limits.channels) {
      counts.add_cause(one_line(cause.name()), cause.value());
    }
  }
  dropped_in_service = status.dropped_in_service();
  if (!continues) {
    first_counts = counts;
    first_dropped_in_service = dropped_in_service;
  }
  buffer_fill = status.buffer_fill();
  matched_readers = status.matched_readers();
  message = one_line(status.message());
  if (continues && lost() > lost_before) {
    lost_more = now;
  }
}

Condition condition_of(const Source& source, bus::Clock::Instant now) {
  Condition condition;
  if (source.is_silent && source.state != SourceState::ended) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(now - source.heard);
    condition.raise_severity(Severity::stale,
                             fmt::format("{}: not heard for {} s", source.name, seconds.count()));
  }
  const auto reason = [&](const char* otherwise) {
    return fmt::format("{}: {}", source.name, source.message.empty() ? otherwise : source.message);
  };
  if (source.state == SourceState::failed) {
    condition.raise_severity(Severity::error, reason("failed"));
  } else if (source.state == SourceState::silent) {
    condition.raise_severity(Severity::error, reason("its instrument sends nothing"));
  } else if (!source.message.empty()) {
    condition.raise_severity(Severity::warning, reason(""));
  }
  const auto samples = fmt::format("{}: {} samples lost", source.name, source.lost());
  if (source.lost_more && now - *source.lost_more < loss_limit) {
    condition.raise_severity(Severity::warning, samples);
  }
  if (source.buffer_fill > 0.5) {
    condition.raise_severity(
        Severity::warning,
        fmt::format("{}: its buffer is {:.0f} % full: the network does not take its "
                    "samples",
                    source.name, source.buffer_fill * 100.0));
  }
  if (source.lost() > 0) {
    condition.raise_severity(Severity::note, samples);
  }
  if (source.counts.stamps_not_trusted > 0) {
    condition.raise_severity(Severity::note, fmt::format("{}: {} stamps not trusted", source.name,
                                                         source.counts.stamps_not_trusted));
  }
  return condition;
}

} // namespace dyncal::network
