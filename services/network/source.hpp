// A source of a bench as it describes itself and as it is now. Plain data; one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "drivers/sample_block.hpp"
#include "drivers/sample_counts.hpp"
#include "idl/dyncal.h"
#include "services/bus/clock.hpp"
#include "services/contract/bench_file_origin.hpp"
#include "services/contract/duplicate_source_detector.hpp"
#include "services/contract/source_kind.hpp"
#include "services/network/condition.hpp"
#include "services/network/limits.hpp"

namespace dyncal::network {

// Of its own report; whether it is heard at all is Source::is_silent.
enum class SourceState { unknown, starting, running, silent, ended, failed };
// "running"
[[nodiscard]] const char* to_string(SourceState state);

struct Source {
  using Instant = bus::Clock::Instant;

  std::string name;
  std::uint64_t session = 0; // of its newest message
  std::optional<SourceKind> kind;
  std::optional<drivers::SourceDescription> description;
  std::string software;
  std::string host;
  std::uint32_t process_id = 0;
  std::uint32_t contract_version = 0;
  BenchFileOrigin bench_file;       // that its service has read
  std::set<std::string> services{}; // that have described it, "lab-2:4711"

  SourceState state = SourceState::unknown; // before its first status
  double rate_hz = 0.0;
  drivers::SampleCounts counts; // samples since its program was started
  std::uint64_t dropped_in_service = 0;
  double buffer_fill = 0.0;
  std::uint32_t matched_readers = 0;
  std::string message;                // empty: nothing is wrong
  drivers::SampleCounts first_counts; // of its session, since we listen
  std::uint64_t first_dropped_in_service = 0;
  std::optional<std::uint64_t> counted_session; // of its statuses
  DuplicateSourceDetector turns;                // of the sessions of its statuses

  Instant heard{};
  std::int64_t heard_utc_ns = 0;
  std::optional<Instant> lost_more; // when its losses have risen last, since we listen
  bool is_silent = false;           // nothing was heard for silence_limit

  [[nodiscard]] std::uint64_t lost() const {
    return counts.lost_in_device + counts.lost_on_way + dropped_in_service;
  }

  void take(const wire::SourceDescription& message, const Limits& limits);
  void take(const wire::SourceStatus& message, const Limits& limits, Instant now);
};

[[nodiscard]] Condition condition_of(const Source& source, bus::Clock::Instant now);

} // namespace dyncal::network
