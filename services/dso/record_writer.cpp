#include "services/dso/record_writer.hpp"

#include <utility>

#include "drivers/utc_clock.hpp"
#include "services/contract/topics.hpp"
#include "services/version.hpp"

namespace dyncal::services::dso {
namespace {

constexpr auto status_interval = std::chrono::milliseconds(500);

} // namespace

Expected<RecordWriter> RecordWriter::create(bus::Participant& participant, const std::string& bench,
                                            const std::string& source, const std::string& topic,
                                            wire::SourceKind kind, std::uint64_t session) {
  auto description = participant.writer<wire::SourceDescription>(bus::topics::source_description,
                                                                 bus::Profile::state, bench);
  if (!description) {
    return fail(description.error());
  }
  auto status = participant.writer<wire::SourceStatus>(bus::topics::source_status,
                                                       bus::Profile::state, bench);
  if (!status) {
    return fail(status.error());
  }
  auto records = participant.writer<wire::TriggeredRecord>(topic, bus::Profile::samples, bench);
  if (!records) {
    return fail(records.error());
  }
  return RecordWriter(bench, source, kind, session, std::move(*description), std::move(*status),
                      std::move(*records));
}

void RecordWriter::describe(wire::SourceDescription description) {
  description.bench(bench_);
  description.source(source_);
  description.session(session_);
  description.kind(kind_);
  description.software(software_version());
  description.time_base(wire::TIME_BASE_LOCAL);
  description.stamp_instant(wire::STAMP_TRIGGER_EDGE);
  description.contract_version(wire::CONTRACT_VERSION);
  if (description_ && *description_ == description) {
    return;
  }
  description_writer_.write(description);
  description_ = std::move(description);
}

void RecordWriter::answer(const std::string& run) {
  wire::TriggeredRecord record;
  record.acknowledged_run(run);
  write(std::move(record));
}

bool RecordWriter::write(wire::TriggeredRecord record) {
  const bool holds_samples = record.sample_count() > 0;
  record.bench(bench_);
  record.source(source_);
  record.session(session_);
  if (record_writer_.write(record) != bus::WriteOutcome::written) {
    ++not_written_;
    return false;
  }
  written_ += holds_samples ? 1 : 0;
  return true;
}

void RecordWriter::status(wire::SourceState state, const std::string& message,
                          std::chrono::steady_clock::time_point now) {
  if (state_ == state && message_ == message && now < next_status_) {
    return;
  }
  state_ = state;
  message_ = message;
  next_status_ = now + status_interval;
  wire::SourceStatus status;
  status.bench(bench_);
  status.source(source_);
  status.session(session_);
  status.state(state);
  status.published_utc_ns(utc_now_ns());
  status.received(written_ + rejected_ + not_written_);
  status.rejected(rejected_);
  status.dropped_in_service(not_written_);
  status.matched_readers(static_cast<std::uint32_t>(record_writer_.matched_readers()));
  status.message(message);
  status_writer_.write(status);
}

void RecordWriter::end() {
  wire::TriggeredRecord record;
  record.end_of_stream(true);
  write(std::move(record));
  status(wire::SOURCE_ENDED, "", std::chrono::steady_clock::now());
  record_writer_.wait_for_acknowledgments(std::chrono::seconds(2));
}

} // namespace dyncal::services::dso
