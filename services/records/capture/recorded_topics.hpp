// The topics of the contract that a recording has, as schemas and channels of the file: every topic
// of a bench's partition. A schema is the whole IDL text, as encoding "omgidl" wants it; messages
// are plain CDR with their 4-byte header, as services/bus/type_support.hpp makes them.
//
// Answers to requests are recorded as what they repeat, under the topic of their source. Plain
// data and functions, any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "idl/dyncal.h"
#include "services/bus/type_support.hpp"
#include "services/contract/topics.hpp"
#include "services/records/mcap/mcap_record.hpp"

namespace dyncal::inline records::recording {

// The contract, idl/dyncal.idl.
[[nodiscard]] std::string_view idl_text();

// Calls `visit` with each Topic<T>.
template <class Visit>
void for_each_recorded_topic(Visit visit) {
  namespace topics = bus::topics;
  visit(topics::source_description);
  visit(topics::source_status);
  visit(topics::dau_samples);
  visit(topics::acs_samples);
  visit(topics::can_samples);
  visit(topics::dso_record);
  visit(topics::tss_record);
  visit(topics::acs_step);
  visit(topics::measurement);
  visit(topics::excitation);
  visit(topics::calibration_result);
  visit(topics::transfer_function);
  visit(topics::sample_clock_report);
  visit(topics::service_status);
  visit(topics::command);
  visit(topics::catch_up_request);
}

[[nodiscard]] const std::vector<Schema>& recorded_schemas();
[[nodiscard]] const std::vector<Channel>& recorded_channels();
// REQUIRES: a recorded topic.
[[nodiscard]] const Channel& channel_of(std::string_view topic);

// Whole message as bytes; empty if it cannot be encoded.
template <class T>
[[nodiscard]] std::string encode(const T& message) {
  const bus::EncodedMessage bytes = bus::encode(message);
  return bytes ? *bytes : std::string();
}

// Nothing if the bytes are no such message.
template <class T>
[[nodiscard]] std::optional<T> decode(std::string_view bytes) {
  T message;
  return bus::type_support<T>().deserialize(&message, bytes.data(), bytes.size())
             ? std::optional(std::move(message))
             : std::nullopt;
}

// When the message was written by the clock of its writer, where it says so; 0: it does not.
template <class T>
[[nodiscard]] std::int64_t written_utc_ns(const T& message) {
  if constexpr (requires { message.received_utc_ns(); }) {
    return message.received_utc_ns();
  } else if constexpr (requires { message.published_utc_ns(); }) {
    return message.published_utc_ns();
  } else {
    return 0;
  }
}

template <class T>
inline constexpr bool is_of_source =
    std::is_same_v<T, wire::SampleBlock> || std::is_same_v<T, wire::TriggeredRecord>;

} // namespace dyncal::inline records::recording
