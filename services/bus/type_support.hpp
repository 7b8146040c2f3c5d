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
#include <string>
#include <vector>

#include "idl/dyncal.h"

namespace dyncal::bus {

// The key members of a type. They stand first in its struct: bounded strings, then unsigned 32-bit
// numbers.
struct KeyLayout {
  std::vector<std::size_t> string_bounds; // longest length of each string, without its end
  std::size_t numbers = 0;
};

struct TypeSupport {
  std::string name; // as DDS announces it, e.g. "dyncal::wire::SampleBlock"
  KeyLayout key;
  void* (*create)();
  void (*destroy)(void* sample);
  std::size_t (*serialized_size)(const void* sample);
  // Bytes written; 0 if the sample does not fit `capacity` or cannot be encoded.
  std::size_t (*serialize)(const void* sample, char* bytes, std::size_t capacity);
  // The same for header and key members alone.
  std::size_t (*serialize_key)(const void* sample, char* bytes, std::size_t capacity);
  // The key members as DDS identifies an instance by them: big-endian, no header, padding
  // zero. Bytes written; 0 if they do not fit.
  std::size_t (*canonical_key)(const void* sample, char* bytes, std::size_t capacity);
  // Returns false if the bytes are not such a message; the sample then holds an unspecified part of
  // it.
  bool (*deserialize)(void* sample, const char* bytes, std::size_t count);
};

// Exists for every topic type of the contract; a new one is added at the end of type_support.cpp.
template <class T>
[[nodiscard]] const TypeSupport& type_support();

template <>
const TypeSupport& type_support<wire::SourceDescription>();
template <>
const TypeSupport& type_support<wire::SourceStatus>();
template <>
const TypeSupport& type_support<wire::SampleBlock>();
template <>
const TypeSupport& type_support<wire::TriggeredRecord>();
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
