// A message type of the contract as Cyclone DDS wants it: samples that are already bytes.
//
// Cyclone DDS lets a program bring its own representation of types ("sertype") and samples
// ("serdata"). Ours holds the payload that TypeSupport encoded, shared with whoever else keeps it,
// and the key read from it; so the bytes are those of Fast DDS, no type information is announced,
// and the end of an instance is understood even when its sender gives nothing but the MD5 of the
// key (as Fast DDS does).
//
// The headers behind this are installed but not promised to stay: all that needs them is in
// cyclone_dds_type.cpp.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "services/bus/cdr_key.hpp"
#include "services/bus/malformed_messages.hpp"
#include "services/bus/type_support.hpp"

struct ddsi_domaingv;
struct ddsi_sertype;
struct ddsi_serdata;

namespace dyncal::bus {

// What dds_write() takes as a sample.
struct OutgoingMessage {
  EncodedMessage payload;
  std::shared_ptr<const Instance> instance;
};

[[nodiscard]] KeyHash cyclone_dds_key_hash(const std::string& canonical_key);

// The caller owns one reference, which dds_create_topic_sertype() takes over when it succeeds.
// `type` must live as long as the process.
[[nodiscard]] ddsi_sertype* make_cyclone_sertype(const TypeSupport& type,
                                                 std::shared_ptr<MalformedMessages> malformed);
void release_cyclone_sertype(ddsi_sertype* sertype);
// REQUIRES: dds_create_topic_sertype() has given it.
[[nodiscard]] const ddsi_domaingv& domain_of(const ddsi_sertype& sertype);

// Decodes what dds_takecdr() gave: a whole sample, or one with key members only. False when the
// bytes are not a message of the type.
[[nodiscard]] bool read_cyclone_serdata(const TypeSupport& type, const ddsi_serdata* serdata,
                                        void* sample);
// The bytes of it; they last until it is released.
[[nodiscard]] std::string_view payload_of(const ddsi_serdata* serdata);
void release_cyclone_serdata(ddsi_serdata* serdata);

} // namespace dyncal::bus
