#include "services/stream/stream_writer.hpp"

#include <utility>

#include "services/stream/messages.hpp"

namespace dyncal::inline stream {

namespace {

template <class Message>
class WriterOf : public StreamWriter {
public:
  WriterOf(SourceOptions source, bus::Writer<Message> writer)
      : source_(std::move(source)), writer_(std::move(writer)) {}

  bus::WriteOutcome write(std::chrono::nanoseconds limit) override {
    return writer_.write_encoded(next_.payload, limit);
  }
  std::size_t keep_in(RetransmissionBuffer& kept) override {
    const std::size_t bytes = next_.payload ? next_.payload->size() : 0;
    if (bytes > 0) {
      kept.keep(std::move(next_), std::chrono::steady_clock::now());
    }
    return bytes;
  }
  bool wait_for_acknowledgments(std::chrono::nanoseconds limit) override {
    return writer_.wait_for_acknowledgments(limit);
  }
  [[nodiscard]] int matched_readers() const override { return writer_.matched_readers(); }

protected:
  // The only place where a block or record becomes bytes.
  void encode(Message message, bool end_of_stream, const std::string& answers_run) {
    message.end_of_stream(end_of_stream);
    message.acknowledged_run(answers_run);
    next_ = {.session = message.session(),
             .number = number_of(message),
             .acknowledged_run = answers_run,
             .payload = bus::encode(message)};
  }

  const SourceOptions source_;

private:
  static std::uint64_t number_of(const wire::SampleBlock& message) { return message.block(); }
  static std::uint64_t number_of(const wire::TriggeredRecord& message) { return message.shot(); }

  bus::Writer<Message> writer_;
  KeptMessage next_;
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
    encode(to_message(source_, session_, block_number_++, std::move(entry.block)),
           entry.end_of_stream, answers_run);
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
    encode(to_message(source_, entry.session, entry.shot.value_or(Shot{}), std::move(entry.block)),
           entry.end_of_stream, answers_run);
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

} // namespace dyncal::inline stream
