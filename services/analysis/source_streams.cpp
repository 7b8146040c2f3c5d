#include "services/analysis/source_streams.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/source_kind.hpp"
#include "services/contract/triggered_record.hpp"

namespace dyncal::services {
namespace {

std::string reason_given_by(const KnownSource& source) {
  const bool gives_one = source.status && !source.status->message().empty();
  return gives_one ? ": " + source.status->message() : "";
}

bool is_silent(const KnownSource& source) {
  return source.status && (source.status->state() == wire::SOURCE_SILENT ||
                           source.status->state() == wire::SOURCE_FAILED);
}

} // namespace

SourceStreams::SourceStreams(bus::Participant& participant, std::shared_ptr<bus::WakeUp> wake_up,
                             std::string bench, std::string run,
                             const std::vector<std::string>& sources)
    : participant_(participant), wake_up_(std::move(wake_up)), bench_(std::move(bench)),
      run_(std::move(run)) {
  for (const std::string& source : sources) {
    streams_.emplace(source, Stream{});
  }
}

Expected<void> SourceStreams::take_descriptions(const KnownSources& known,
                                                RunEvaluator& evaluator) {
  for (auto& [name, stream] : streams_) {
    const auto source = known.find(name);
    if (source == known.end() || !source->second.description ||
        source->second.description == stream.description) {
      continue;
    }
    if (auto described = describe(stream, *source->second.description, evaluator); !described) {
      return described;
    }
  }
  return {};
}

Expected<void> SourceStreams::describe(Stream& stream, const wire::SourceDescription& description,
                                       RunEvaluator& evaluator) {
  const bool same_session = stream.description &&
                            stream.description->session() == description.session() &&
                            !stream.triggered;
  stream.description = description;
  if (same_session) {
    return {}; // what its samples mean was known from the beginning
  }
  if (auto accepted =
          evaluator.describe(description.source().to_string(), from_message(description));
      !accepted) {
    return accepted;
  }
  stream.described = true;
  stream.triggered = is_triggered(from_wire(description.kind()));
  return stream.triggered ? open_reader(record_readers_, description.kind())
                          : open_reader(block_readers_, description.kind());
}

template <class Message>
Expected<void> SourceStreams::open_reader(std::map<wire::SourceKind, bus::Reader<Message>>& readers,
                                          wire::SourceKind kind) {
  if (readers.contains(kind)) {
    return {};
  }
  auto reader = participant_.reader<Message>(sample_topic(from_wire(kind)),
                                             bus::Profile::live_samples, bench_, wake_up_);
  if (!reader) {
    return fail(reader.error());
  }
  readers.emplace(kind, std::move(*reader));
  return {};
}

void SourceStreams::take_samples(Instant now, RunEvaluator& evaluator) {
  for (auto& [kind, reader] : block_readers_) {
    take(reader, now, evaluator);
  }
  for (auto& [kind, reader] : record_readers_) {
    take(reader, now, evaluator);
  }
}

template <class Message>
void SourceStreams::take(bus::Reader<Message>& reader, Instant now, RunEvaluator& evaluator) {
  reader.take([&](const Message& message) {
    // Another bench's block in this bench's partition is not of this bench.
    const auto found =
        message.bench() == bench_ ? streams_.find(message.source().to_string()) : streams_.end();
    if (found == streams_.end()) {
      return;
    }
    Stream& stream = found->second;
    stream.twins.add(message.session());
    stream.answered = stream.answered || message.acknowledged_run() == run_;
    if (stream.answered) {
      stream.last_sent = now;
      stream.ended = message.end_of_stream();
      hand_over(found->first, message, evaluator);
    }
  });
}

void SourceStreams::hand_over(const std::string& source, const wire::SampleBlock& block,
                              RunEvaluator& evaluator) const {
  evaluator.add(source, view_block(block));
}

void SourceStreams::hand_over(const std::string& source, const wire::TriggeredRecord& record,
                              RunEvaluator& evaluator) const {
  if (record.run() == run_) {
    evaluator.add(source, from_message(record));
  }
}

void SourceStreams::close_readers() {
  block_readers_.clear();
  record_readers_.clear();
}

std::vector<std::string> SourceStreams::unanswered() const {
  std::vector<std::string> names;
  for (const auto& [name, stream] : streams_) {
    if (stream.described && !stream.answered) {
      names.push_back(name);
    }
  }
  return names;
}

std::string SourceStreams::what_is_missing(const KnownSources& known) const {
  for (const auto& [name, stream] : streams_) {
    const auto found = known.find(name);
    if (found == known.end()) {
      return fmt::format("source '{}' of bench '{}' is not on the network; is its service running "
                         "with this bench file, in the same DDS domain?",
                         name, bench_);
    }
    const KnownSource& source = found->second;
    if (is_silent(source)) {
      return fmt::format("source '{}' of bench '{}' is silent{}", name, bench_,
                         reason_given_by(source));
    }
    if (stream.twins.twins()) {
      return two_send_as(name);
    }
    if (!stream.described) {
      return fmt::format("source '{}' of bench '{}' has not described its channels yet{}", name,
                         bench_, reason_given_by(source));
    }
    if (!stream.answered) {
      return fmt::format("source '{}' of bench '{}' does not answer in its sample stream; do "
                         "samples get through from its host to this one?",
                         name, bench_);
    }
  }
  return "";
}

std::string SourceStreams::two_send_as(const std::string& source) const {
  return fmt::format("two services send as source '{}' of bench '{}'; end one of them, or give it "
                     "another name",
                     source, bench_);
}

std::optional<std::string> SourceStreams::lost_source(Instant now, Instant watched_from,
                                                      std::chrono::seconds silence_limit,
                                                      bool may_not_end) const {
  for (const auto& [name, stream] : streams_) {
    if (stream.twins.twins()) {
      return two_send_as(name);
    }
    if (stream.ended && may_not_end) {
      return fmt::format("source '{}' of bench '{}' has ended before the run", name, bench_);
    }
    if (!stream.ended && !stream.triggered &&
        now - std::max(stream.last_sent, watched_from) > silence_limit) {
      return fmt::format("source '{}' of bench '{}' has sent nothing for {} s", name, bench_,
                         silence_limit.count());
    }
  }
  return std::nullopt;
}

} // namespace dyncal::services
