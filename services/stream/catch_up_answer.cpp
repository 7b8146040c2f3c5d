#include "services/stream/catch_up_answer.hpp"

#include <utility>

#include "services/bus/payload_checksum.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline stream {

namespace {

constexpr auto match_limit = std::chrono::seconds(10);    // for the asker's reader to be found
constexpr auto absence_limit = std::chrono::seconds(3);   // of a reader that was there
constexpr auto progress_limit = std::chrono::seconds(20); // without an acknowledgment
constexpr int messages_per_step = 16;                     // so that the others get their turn
// On the wire at once: 200 ms of a link of 10 Mbit/s, beside the live messages.
constexpr WritePace::Window window{.messages = 100, .bytes = std::size_t{256} << 10U};

template <class Message>
class WriterOf : public CatchUpWriter {
public:
  WriterOf(SourceOptions source, bus::Writer<Message> writer)
      : source_(std::move(source)), writer_(std::move(writer)) {}

  bus::WriteOutcome write(const bus::EncodedMessage& payload) override {
    if (!bus::ends_with_checksum(payload->data(), payload->size())) {
      return bus::WriteOutcome::failed;
    }
    return writer_.write_encoded(payload, std::chrono::nanoseconds(0));
  }
  bus::WriteOutcome write_end(std::uint64_t session, std::uint64_t number,
                              const std::string& request) override {
    Message end;
    end.bench(source_.bench);
    end.source(source_.source);
    end.session(session);
    set_number(end, number);
    end.acknowledged_run(request);
    return writer_.write(end, std::chrono::nanoseconds(0));
  }
  bool acknowledged() override {
    return writer_.wait_for_acknowledgments(std::chrono::nanoseconds(0));
  }
  [[nodiscard]] int matched_readers() const override { return writer_.matched_readers(); }

private:
  static void set_number(wire::SampleBlock& message, std::uint64_t number) {
    message.block(number);
  }
  static void set_number(wire::TriggeredRecord& message, std::uint64_t number) {
    message.shot(number);
  }

  const SourceOptions source_;
  bus::Writer<Message> writer_;
};

template <class Message>
Expected<std::unique_ptr<CatchUpWriter>>
open(bus::Participant& participant, const bus::Topic<Message>& topic, const SourceOptions& source,
     const std::string& asker) {
  DYNCAL_TRY(auto writer, participant.writer(topic, asker));
  return std::make_unique<WriterOf<Message>>(source, std::move(writer));
}

} // namespace

Expected<std::unique_ptr<CatchUpWriter>> CatchUpWriter::create(bus::Participant& participant,
                                                               const SourceOptions& source,
                                                               const std::string& asker) {
  return is_triggered(source.kind)
             ? open(participant, bus::topics::catch_up_records, source, asker)
             : open(participant, bus::topics::catch_up_samples, source, asker);
}

CatchUpAnswer::CatchUpAnswer(CatchUpOptions wish, std::shared_ptr<RetransmissionBuffer> kept,
                             std::unique_ptr<CatchUpWriter> writer, Instant now)
    : wish_(std::move(wish)), kept_(std::move(kept)), writer_(std::move(writer)),
      pace_(window, 2 * progress_limit), session_(wish_.session), number_(wish_.after),
      reader_seen_(now), progress_(now) {}

bool CatchUpAnswer::reader_is_gone(Instant now) {
  if (writer_->matched_readers() > 0) {
    reader_seen_ = now;
    return false;
  }
  return now - reader_seen_ > (state_ == State::waiting ? match_limit : absence_limit);
}

// Returns false if nothing could be written now.
bool CatchUpAnswer::give_next(Instant now) {
  auto found = kept_->at_or_behind(next_);
  if (!found || found->place >= end_) {
    next_ = end_;
    return true;
  }
  if (writer_->write(found->payload) == bus::WriteOutcome::timed_out) {
    return false;
  }
  pace_.wrote(found->payload->size());
  progress_ = now;
  ++messages_given_;
  next_ = found->place + 1;
  session_ = found->session;
  number_ = found->number;
  return true;
}

bool CatchUpAnswer::give_end(Instant now) {
  if (writer_->write_end(session_, number_, wish_.request) == bus::WriteOutcome::timed_out) {
    return false;
  }
  progress_ = now;
  state_ = State::closing;
  return true;
}

CatchUpAnswer::State CatchUpAnswer::give(Instant now) {
  for (int i = 0; i < messages_per_step && state_ == State::giving; ++i) {
    if (!pace_.may_write(now, [&] { return writer_->acknowledged(); })) {
      break;
    }
    if (next_ < end_) {
      if (!give_next(now)) {
        break;
      }
    } else if (!end_is_final_) {
      end_ = kept_->end(); // what was written meanwhile; only once, since a slow link never ends
      end_is_final_ = true;
    } else if (!give_end(now)) {
      break;
    }
  }
  return state_;
}

CatchUpAnswer::State CatchUpAnswer::step(Instant now) {
  if (state_ == State::given || state_ == State::broken_off) {
    return state_;
  }
  if (reader_is_gone(now) || now - progress_ > progress_limit) {
    return state_ = State::broken_off;
  }
  if (state_ == State::waiting) {
    if (writer_->matched_readers() == 0) {
      return state_;
    }
    next_ = kept_->place_behind(wish_.session, wish_.after, wish_.run);
    end_ = kept_->end();
    progress_ = now;
    state_ = State::giving;
  }
  if (state_ == State::giving) {
    return give(now);
  }
  if (writer_->acknowledged()) {
    state_ = State::given;
  }
  return state_;
}

} // namespace dyncal::inline stream
