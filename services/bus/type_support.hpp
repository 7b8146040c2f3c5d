// What the bus needs to know of a message type: its name, its key, and how it turns into bytes and
// back.
//
// One set of C++ types (made from idl/dyncal.idl) and one encoder serve every vendor, so the bytes
// on the wire are the same by construction. Bytes here mean a whole DDS payload: the 4-byte
// encapsulation header, then plain CDR (XCDR1).
//
// Growth: members may be appended to a type. A message from an older program lacks those that were
// appended since the first release; deserialize() then reads zeros, empty strings and empty
// sequences. A message from a newer program has bytes at its end that are left unread.
//
// A message that was changed on its way is refused (payload_checksum.hpp): serialize() sets the
// member `checksum`, whatever the sample has there, and deserialize() leaves 0 in it.
//
// All functions may be called from any thread; a sample belongs to its caller.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "idl/dyncal.h"

namespace dyncal::bus {

// The key members of a type. They stand first in its struct: bounded strings, then unsigned 32-bit
// numbers.
struct KeyLayout {
  std::vector<std::size_t> string_bounds; // longest length of each string, without its end
  std::size_t numbers = 0;
};

// A message as bytes, which never change: who sends, keeps and records it shares them.
using EncodedMessage = std::shared_ptr<const std::string>;

struct TypeSupport {
  std::string name; // as DDS announces it, e.g. "dyncal::wire::SampleBlock"
  KeyLayout key;
  void* (*create)();
  void (*destroy)(void* sample);
  std::size_t (*serialized_size)(const void* sample);
  // Bytes written; 0 if the sample does not fit `capacity` or cannot be encoded. REQUIRES: `bytes`
  // are zero, because padding stays as it is.
  std::size_t (*serialize)(const void* sample, char* bytes, std::size_t capacity);
  // Returns false if the bytes are not such a message; the sample then holds an unspecified part of
  // it.
  bool (*deserialize)(void* sample, const char* bytes, std::size_t count);
};

// Null if the sample cannot be encoded.
[[nodiscard]] EncodedMessage encode(const TypeSupport& type, const void* sample);

// Whether bytes that deserialize() has read into `sample` are a message with all members of this
// contract and its checksum, as encode() makes them: they may be kept in place of the sample.
[[nodiscard]] bool is_whole(const TypeSupport& type, const void* sample, std::string_view bytes);

// Exists for every topic type of the contract; a new one is added at the end of type_support.cpp.
template <class T>
[[nodiscard]] const TypeSupport& type_support();

template <class T>
[[nodiscard]] EncodedMessage encode(const T& message) {
  return encode(type_support<T>(), &message);
}

template <>
const TypeSupport& type_support<wire::SourceDescription>();
template <>
const TypeSupport& type_support<wire::SourceStatus>();
template <>
const TypeSupport& type_support<wire::SampleBlock>();
template <>
const TypeSupport& type_support<wire::TriggeredRecord>();
template <>
const TypeSupport& type_support<wire::AcsStep>();
template <>
const TypeSupport& type_support<wire::Measurement>();
template <>
const TypeSupport& type_support<wire::Excitation>();
template <>
const TypeSupport& type_support<wire::CalibrationResult>();
template <>
const TypeSupport& type_support<wire::TransferFunction>();
template <>
const TypeSupport& type_support<wire::SampleClockReport>();
template <>
const TypeSupport& type_support<wire::ServiceStatus>();
template <>
const TypeSupport& type_support<wire::Command>();
template <>
const TypeSupport& type_support<wire::CatchUpRequest>();
template <>
const TypeSupport& type_support<wire::ClockRequest>();
template <>
const TypeSupport& type_support<wire::ClockAnswer>();
template <>
const TypeSupport& type_support<wire::LinkProbe>();
template <>
const TypeSupport& type_support<wire::LinkEcho>();

} // namespace dyncal::bus
