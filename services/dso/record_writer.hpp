// The bus side of one source of triggered records (an oscilloscope or a time series sensor):
// description, status, records, answers to ARM.
//
// An answer is an empty record that names the run, in the same stream and behind everything written
// before it. One thread; write() may block for seconds, which holds up the next shot but loses
// nothing: devices deliver one shot at a time, when asked.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "services/bus/bus.hpp"
#include "services/error.hpp"

#include "idl/dyncal.h"

namespace dyncal::services::dso {

class RecordWriter {
public:
  // `topic` is DsoRecord or TssRecord.
  [[nodiscard]] static Expected<RecordWriter>
  create(bus::Participant& participant, const std::string& bench, const std::string& source,
         const std::string& topic, wire::SourceKind kind, std::uint64_t session);

  // Publishes when it differs from the last one. Bench, source, session and software are filled in
  // here.
  void describe(wire::SourceDescription description);
  [[nodiscard]] bool described() const { return description_.has_value(); }

  void answer(const std::string& run);
  // Key members are filled in here. False when it could not be written.
  bool write(wire::TriggeredRecord record);
  // Published at once when state or message change, else every half second.
  void status(wire::SourceState state, const std::string& message,
              std::chrono::steady_clock::time_point now);
  void count_rejected() { ++rejected_; }
  void end();

private:
  RecordWriter(std::string bench, std::string source, wire::SourceKind kind, std::uint64_t session,
               bus::Writer<wire::SourceDescription> description,
               bus::Writer<wire::SourceStatus> status, bus::Writer<wire::TriggeredRecord> records)
      : bench_(std::move(bench)), source_(std::move(source)), kind_(kind), session_(session),
        description_writer_(std::move(description)), status_writer_(std::move(status)),
        record_writer_(std::move(records)) {}

  std::string bench_;
  std::string source_;
  wire::SourceKind kind_;
  std::uint64_t session_;
  bus::Writer<wire::SourceDescription> description_writer_;
  bus::Writer<wire::SourceStatus> status_writer_;
  bus::Writer<wire::TriggeredRecord> record_writer_;
  std::optional<wire::SourceDescription> description_;
  std::uint64_t written_ = 0;
  std::uint64_t rejected_ = 0;
  std::uint64_t not_written_ = 0;
  std::optional<wire::SourceState> state_;
  std::string message_;
  std::chrono::steady_clock::time_point next_status_{};
};

} // namespace dyncal::services::dso
