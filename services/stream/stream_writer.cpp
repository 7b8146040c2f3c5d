#include "services/stream/stream_writer.hpp"

#include <utility>

#include "services/stream/messages.hpp"

namespace dyncal::services {

namespace {

template <class Message>
class WriterOf : public StreamWriter {
public:
  WriterOf(SourceOptions source, bus::Writer<Message> writer)
      : source_(std::move(source)), writer_(std::move(writer)) {}

  bus::WriteOutcome write(std::chrono::nanoseconds limit) override {
    return writer_.write(message_, limit);
  }
  std::size_t keep_in(RetransmissionBuffer& kept) const override {
    const bus::TypeSupport& type = bus::type_support<Message>();
    std::string payload(type.serialized_size(&message_), '\0');
    payload.resize(type.serialize(&message_, payload.data(), payload.size()));
    const std::size_t bytes = payload.size();
    kept.keep({.session = message_.session(),
               .number = number_of(message_),
               .acknowledged_run = message_.acknowledged_run(),
               .payload = std::move(payload)},
              std::chrono::steady_clock::now());
    return bytes;
  }
  bool wait_for_acknowledgments(std::chrono::nanoseconds limit) override {
    return writer_.wait_for_acknowledgments(limit);
  }
  [[nodiscard]] int matched_readers() const override { return writer_.matched_readers(); }

protected:
  const SourceOptions source_;
  Message message_;

private:
  static std::uint64_t number_of(const wire::SampleBlock& message) { return message.block(); }
  static std::uint64_t number_of(const wire::TriggeredRecord& message) { return message.shot(); }

  bus::Writer<Message> writer_;
};

class BlockWriter : public WriterOf<wire::SampleBlock> {
public:
  using WriterOf::WriterOf;

  void prepare(RingEntry entry, const std::string& answers_run) override {
    if (entry.session != session_) {
      session_ = entry.session;
      block_number_ = 0;
      next_sample_ = 0;
    }
    if (entry.block.samples > 0) {
      next_sample_ = entry.block.first_sample;
    } else {
      entry.block.first_sample = next_sample_;
    }
    next_sample_ += entry.block.samples;
    message_ = to_message(source_, session_, block_number_++, std::move(entry.block));
    message_.end_of_stream(entry.end_of_stream);
    message_.acknowledged_run(answers_run);
  }

private:
  std::uint64_t session_ = 0;
  std::uint64_t block_number_ = 0; // of the next block of the session
  std::uint64_t next_sample_ = 0;
};

class RecordWriter : public WriterOf<wire::TriggeredRecord> {
public:
  using WriterOf::WriterOf;

  void prepare(RingEntry entry, const std::string& answers_run) override {
    message_ =
        to_message(source_, entry.session, entry.shot.value_or(Shot{}), std::move(entry.block));
    message_.end_of_stream(entry.end_of_stream);
    message_.acknowledged_run(answers_run);
  }
};

template <class Kind, class Message>
Expected<std::unique_ptr<StreamWriter>>
open(bus::Participant& participant, const SourceOptions& source, bus::Profile live_profile) {
  const auto profile = waits(source.when_full) ? bus::Profile::paced_samples : live_profile;
  DYNCAL_TRY(auto writer,
             participant.writer<Message>(sample_topic(source.kind), profile, source.bench));
  return std::make_unique<Kind>(source, std::move(writer));
}

} // namespace

Expected<std::unique_ptr<StreamWriter>> StreamWriter::create(bus::Participant& participant,
                                                             const SourceOptions& source) {
  return is_triggered(source.kind)
             ? open<RecordWriter, wire::TriggeredRecord>(participant, source,
                                                         bus::Profile::live_records)
             : open<BlockWriter, wire::SampleBlock>(participant, source,
                                                    bus::Profile::live_samples);
}

} // namespace dyncal::services
