#include "services/programs/analysis/source_streams.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "services/bus/participant_name.hpp"
#include "services/contract/bench_file_origin.hpp"
#include "services/contract/reference_step.hpp"
#include "services/contract/session_number.hpp"
#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/source_kind.hpp"
#include "services/contract/topics.hpp"
#include "services/contract/triggered_record.hpp"

namespace dyncal::inline programs {
SourceStreams::SourceStreams(bus::Participant& participant, std::shared_ptr<bus::WakeUp> wake_up,
                             std::shared_ptr<LeftOutMessages> left_out, std::string bench,
                             std::string run, RunEvaluator& evaluator, Begin begin)
    : participant_(participant), wake_up_(std::move(wake_up)), left_out_(std::move(left_out)),
      bench_(std::move(bench)), run_(std::move(run)),
      asker_(fmt::format("{}/catch-up/{:016x}", bench_, random_session())), evaluator_(evaluator),
      begin_(begin) {
  for (const std::string& source : evaluator_.recipe().sources()) {
    streams_.emplace(source, Stream{});
  }
  if (const std::string& table = evaluator_.recipe().reference_table; !table.empty()) {
    streams_.emplace(table, Stream{}); // its blocks, which have no samples, show that it is there
  }
}

Expected<void> SourceStreams::take_descriptions(const KnownSources& known, Instant now) {
  for (auto& [name, stream] : streams_) {
    const auto source = known.find(name);
    if (source != known.end()) {
      stream.service = service_of(source->second.description);
      stream.service_before = service_of(source->second.before());
    }
    if (source == known.end() || !source->second.description ||
        *source->second.description ==
            (stream.unfit ? stream.unfit->description : stream.description)) {
      continue;
    }
    DYNCAL_TRY(describe(name, stream, *source->second.description, now));
  }
  return {};
}

Expected<void> SourceStreams::describe(const std::string& name, Stream& stream,
                                       const wire::SourceDescription& description, Instant now) {
  if (stream.description && stream.has_answered()) { // from then on its samples are the run's
    std::string other =
        device_difference(name, from_message(*stream.description), from_message(description));
    if (!other.empty()) {
      stream.unfit = {description, std::move(other), true};
      return {};
    }
  }
  const bool same_session = stream.description &&
                            stream.description->session() == description.session() &&
                            !stream.is_triggered();
  if (same_session) { // what its samples mean was known from the beginning
    evaluator_.describe_signals(name, from_message(description).quadrature_signals);
    stream.take(description);
    return {};
  }
  if (stream.description || begin_ == Begin::behind) {
    if (std::string why = rejection_reason(name, description); !why.empty()) {
      stream.unfit = {description, std::move(why), false};
      return {};
    }
  } else if (auto accepted = evaluator_.describe(name, from_message(description)); !accepted) {
    return accepted;
  }
  stream.take(description);
  DYNCAL_TRY(open_steps(name));
  const bool triggered = contract::is_triggered(from_wire(description.kind()));
  if (!stream.follower) {
    stream.follower.emplace(make_follower(name, triggered));
    if (begin_ == Begin::behind) {
      std::visit([&](auto& follower) { follower.start_by_catching_up(now); }, *stream.follower);
    }
  }
  return triggered ? open_reader(record_readers_, description.kind())
                   : open_reader(block_readers_, description.kind());
}

std::string SourceStreams::rejection_reason(const std::string& name,
                                            const wire::SourceDescription& description) {
  const auto& settings = evaluator_.recipe().source_settings;
  if (const auto difference = settings_difference(description.settings(), settings, name)) {
    return refusal(*difference, bench_, name, description.host());
  }
  const auto accepted = evaluator_.describe(name, from_message(description));
  return accepted ? "" : accepted.error().message;
}

// A late joiner is sent the samples of a session whose description the source has replaced.
bool SourceStreams::is_described(const Stream& stream, std::uint64_t session) const {
  return stream.described.contains(session) || (begin_ == Begin::behind && stream.description);
}

SourceStream::Follower SourceStreams::make_follower(const std::string& name, bool triggered) {
  if (triggered) {
    return StreamFollower<wire::TriggeredRecord>(
        run_, asker_, [this, name](const wire::TriggeredRecord& record) {
          Stream& stream = streams_.at(name);
          if (record.run() != run_ || stream.is_unfit(record.session())) {
            return;
          }
          stream.is_undescribed = !is_described(stream, record.session());
          if (!stream.is_undescribed) {
            evaluator_.add(name, from_message(record));
          }
        });
  }
  return StreamFollower<wire::SampleBlock>(
      run_, asker_,
      [this, name](const wire::SampleBlock& block) { hand_over(name, streams_.at(name), block); });
}

void SourceStreams::hand_over(const std::string& name, Stream& stream,
                              const wire::SampleBlock& block) {
  if (!stream.waiting.empty() || stream.is_unfit(block.session()) ||
      !is_described(stream, block.session()) || !evaluator_.is_ready_for(name, block.session())) {
    stream.waiting.add(block);
  } else {
    stream.is_undescribed = false;
    add(name, block);
  }
}

// What waited was heard before: it tells less about the clock of its source, and nothing wrong.
void SourceStreams::add(const std::string& name, const wire::SampleBlock& block) {
  evaluator_.add(name, view_block(block),
                 BlockTimes{block.received_utc_ns(), heard_.time_since_epoch().count()});
}

void SourceStreams::hand_over_waiting(const std::string& name, Stream& stream, Instant now) {
  if (stream.waiting.empty()) {
    stream.waiting_since = now;
    return;
  }
  const bool overdue = now - stream.waiting_since > session_limit;
  while (!stream.waiting.empty()) {
    const wire::SampleBlock& block = stream.waiting.oldest();
    const bool is_undescribed = !is_described(stream, block.session());
    if (is_undescribed && overdue && !stream.is_unfit(block.session())) {
      stream.is_undescribed = true;
      stream.waiting.leave_out_session(block.session());
      continue;
    }
    if (is_undescribed || stream.is_unfit(block.session()) ||
        (!overdue && !evaluator_.is_ready_for(name, block.session()))) {
      return;
    }
    stream.is_undescribed = false;
    add(name, block);
    stream.waiting.take_off_oldest();
  }
}

template <class Message>
Expected<void> SourceStreams::open_reader(std::map<wire::SourceKind, bus::Reader<Message>>& readers,
                                          wire::SourceKind kind) {
  if (readers.contains(kind)) {
    return {};
  }
  DYNCAL_TRY(auto reader,
             participant_.reader<Message>(sample_topic(from_wire(kind)), bus::Profile::live_samples,
                                          bench_, wake_up_));
  readers.emplace(kind, std::move(reader));
  return {};
}

Expected<void> SourceStreams::open_answer_readers() {
  DYNCAL_TRY(auto blocks, participant_.reader(bus::topics::catch_up_samples, asker_, wake_up_));
  DYNCAL_TRY(auto records, participant_.reader(bus::topics::catch_up_records, asker_, wake_up_));
  answer_readers_.emplace(AnswerReaders{std::move(blocks), std::move(records)});
  return {};
}

Expected<void> SourceStreams::open_steps(const std::string& name) {
  if (!steps_ && name == evaluator_.recipe().reference_table) {
    DYNCAL_TRY(auto steps, HandedOutSteps::open(participant_, wake_up_, bench_, run_, name));
    steps_.emplace(std::move(steps));
  }
  return {};
}

void SourceStreams::take_steps() {
  if (!steps_) {
    return;
  }
  Stream& stream = streams_.at(steps_->source());
  steps_->take([&](const wire::AcsStep& step, const bus::WriterId& writer) {
    if (!is_described(stream, step.session())) {
      return false;
    }
    if (!stream.writers.takes(step.session(), writer)) {
      note_second_writer(steps_->source(), stream, step.session(), writer);
      return false;
    }
    evaluator_.add(steps_->source(), from_message(step));
    return true;
  });
}

std::string SourceStreams::steps_not_handed_out() const {
  return steps_ ? steps_->missing(evaluator_.recipe().steps.size()) : "";
}

void SourceStreams::take_samples(Instant now) {
  heard_ = now;
  for (auto& [name, stream] : streams_) {
    hand_over_waiting(name, stream, now);
  }
  const auto live = [&](Stream& stream, const auto& message, auto& follower) {
    stream.twins.add(message.session());
    if (!follower.take_live(message, now)) {
      ++left_out_->of(bench_, message.source().to_string()).duplicates;
    }
  };
  const auto again = [&](Stream& /*stream*/, const auto& message, auto& follower) {
    follower.take_again(message, now);
  };
  if (answer_readers_) {
    take(answer_readers_->blocks, again);
    take(answer_readers_->records, again);
  }
  for (auto& [kind, reader] : block_readers_) {
    take(reader, live);
  }
  for (auto& [kind, reader] : record_readers_) {
    take(reader, live);
  }
  take_steps();
}

template <class Message, class Take>
void SourceStreams::take(bus::Reader<Message>& reader, Take take) {
  reader.take_with_writer([&](const Message& message, const bus::WriterId& writer) {
    // What is given again comes in a partition of this run's own, regardless of who writes there.
    const auto found =
        message.bench() == bench_ ? streams_.find(message.source().to_string()) : streams_.end();
    if (found == streams_.end() || !found->second.follower) {
      return;
    }
    if (!found->second.writers.takes(message.session(), writer)) {
      note_second_writer(found->first, found->second, message.session(), writer);
    } else if (auto* follower = std::get_if<StreamFollower<Message>>(&*found->second.follower)) {
      take(found->second, message, *follower);
    }
  });
}

void SourceStreams::note_second_writer(const std::string& name, Stream& stream,
                                       std::uint64_t session, const bus::WriterId& writer) {
  evaluator_.note_second_writer(name);
  ++left_out_->of(bench_, name).of_other_programs;
  if (stream.second_writer.empty()) {
    const bus::Discovery discovery = participant_.discovered();
    stream.second_writer =
        fmt::format("two programs send in the name of source '{}' of bench '{}': {}, and later {}, "
                    "whose messages are left out; end one of them",
                    name, bench_, bus::name_of(discovery, stream.writers.first(session)),
                    bus::name_of(discovery, writer.participant()));
    spdlog::warn("run {}: {}", run_, stream.second_writer);
  }
}

Expected<std::vector<SourceStreams::Request>> SourceStreams::requests_due(Instant now) {
  std::vector<Request> due;
  for (auto& [name, stream] : streams_) {
    if (!stream.follower) {
      continue;
    }
    if (auto what = std::visit([&](auto& one) { return one.due(now); }, *stream.follower)) {
      due.push_back({name, std::move(*what)});
    }
  }
  if (!due.empty() && !answer_readers_) {
    DYNCAL_TRY(open_answer_readers());
  }
  return due;
}

bool SourceStreams::is_catching_up() const {
  return std::ranges::any_of(streams_, [](const auto& one) { return one.second.is_catching_up(); });
}

bool SourceStreams::is_held_up(Instant now) const {
  return std::ranges::any_of(streams_, [&](const auto& one) { return one.second.is_held_up(now); });
}

std::string SourceStreams::lost_beginning() const {
  for (const auto& [name, stream] : streams_) {
    if (stream.lacks_beginning()) {
      return fmt::format("source '{}' of bench '{}' no longer has what it sent at the beginning of "
                         "the run, or nothing was measured, so it cannot be taken over: begin a "
                         "new run; what was measured before is kept",
                         name, bench_);
    }
  }
  return "";
}

std::uint64_t SourceStreams::recovered() const {
  std::uint64_t messages = 0;
  for (const auto& [name, stream] : streams_) {
    messages += stream.recovered();
  }
  return messages;
}

std::string SourceStreams::second_writer() const {
  const auto found = std::ranges::find_if(
      streams_, [](const auto& stream) { return !stream.second.second_writer.empty(); });
  return found == streams_.end() ? "" : found->second.second_writer;
}

std::vector<std::string> SourceStreams::unanswered() const {
  std::vector<std::string> names;
  for (const auto& [name, stream] : streams_) {
    if (stream.follower && !stream.has_answered()) {
      names.push_back(name);
    }
  }
  return names;
}

std::optional<MissingSource> SourceStreams::what_is_missing(const KnownSources& known) const {
  for (const auto& [name, stream] : streams_) {
    const auto found = known.find(name);
    const KnownSource* source = found == known.end() ? nullptr : &found->second;
    if (auto missing = stream.what_is_missing(bench_, name, source)) {
      return missing;
    }
  }
  return std::nullopt;
}

std::string
SourceStreams::settings_mismatch(const std::map<std::string, std::string>& settings_of_run) const {
  for (const auto& [name, stream] : streams_) {
    if (!stream.description) {
      continue;
    }
    if (const auto difference =
            settings_difference(stream.description->settings(), settings_of_run, name)) {
      return refusal(*difference, bench_, name, stream.description->host());
    }
  }
  return "";
}

std::optional<LostSource> SourceStreams::lost_source(Instant now, Instant watched_from,
                                                     std::chrono::seconds silence_limit,
                                                     bool may_not_end) const {
  const Stream::Patience patience{watched_from, silence_limit, may_not_end};
  for (const auto& [name, stream] : streams_) {
    if (auto lost = stream.loss(bench_, name, now, patience)) {
      return lost;
    }
  }
  return std::nullopt;
}

} // namespace dyncal::inline programs
