#include "services/bus/cyclonedds/cyclone_dds_type.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>
#include <dds/ddsrt/md5.h>

#include "services/bus/cyclonedds/known_keys.hpp"

namespace dyncal::bus {
namespace {

std::shared_ptr<const Instance> instance_of(Key key) {
  const KeyHash hash = cyclone_dds_key_hash(canonical_key(key));
  return std::make_shared<const Instance>(Instance{std::move(key), hash});
}

struct SerType : ddsi_sertype {
  SerType(const TypeSupport& support, std::shared_ptr<MalformedMessages> malformed_messages)
      : ddsi_sertype{}, type(&support), malformed(std::move(malformed_messages)) {}

  const TypeSupport* type;
  const std::shared_ptr<MalformedMessages> malformed; // of the participant
  KnownKeys keys;
};

struct SerData : ddsi_serdata {
  SerData(const ddsi_sertype* sertype, ddsi_serdata_kind data_kind) : ddsi_serdata{} {
    ddsi_serdata_init(this, sertype, data_kind);
  }

  std::shared_ptr<const Instance> instance;
  // Header and members; Cyclone DDS may read up to 3 bytes more, to a multiple of 4.
  EncodedMessage payload;
  std::size_t size = 0; // without those bytes

  void set_payload(EncodedMessage bytes) {
    size = bytes->size();
    payload = std::move(bytes);
    if (size % 4 != 0) {
      std::string padded = *payload;
      padded.resize((size + 3U) & ~std::size_t{3}, '\0');
      payload = std::make_shared<const std::string>(std::move(padded));
    }
  }

  void set_instance(const SerType& sertype, std::shared_ptr<const Instance> own_instance) {
    instance = std::move(own_instance);
    std::uint32_t short_hash = 0;
    std::memcpy(&short_hash, instance->hash.data(), sizeof short_hash);
    hash = sertype.serdata_basehash ^ short_hash;
  }
};

SerType& own(const ddsi_sertype* sertype) {
  return *static_cast<SerType*>(const_cast<ddsi_sertype*>(sertype));
}
const SerData& own(const ddsi_serdata* serdata) {
  return *static_cast<const SerData*>(serdata);
}

ddsi_serdata* make_serdata(const ddsi_sertype* sertype, ddsi_serdata_kind kind,
                           EncodedMessage payload, std::shared_ptr<const Instance> instance) {
  auto* serdata = new SerData(sertype, kind);
  serdata->set_payload(std::move(payload));
  serdata->set_instance(own(sertype), std::move(instance));
  return serdata;
}

// Null when the key of the payload is not the contract's.
ddsi_serdata* received(const ddsi_sertype* sertype, ddsi_serdata_kind kind, std::string payload) {
  SerType& type = own(sertype);
  auto key = read_key(type.type->key, payload.data(), payload.size());
  if (!key) {
    type.malformed->add(type.type->name);
    return nullptr;
  }
  auto instance = instance_of(std::move(*key));
  type.keys.remember(instance->hash, instance->key);
  return make_serdata(sertype, kind, std::make_shared<const std::string>(std::move(payload)),
                      std::move(instance));
}

ddsi_serdata* from_ser(const ddsi_sertype* sertype, ddsi_serdata_kind kind,
                       const nn_rdata* fragment, size_t size) {
  std::string payload(size, '\0');
  // Fragments come in order and may overlap.
  for (std::uint32_t have = 0; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= have) {
      continue;
    }
    const unsigned char* begin = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(payload.data() + have, begin + (have - fragment->min),
                std::min<std::size_t>(fragment->maxp1, size) - have);
    have = fragment->maxp1;
  }
  return received(sertype, kind, std::move(payload));
}

ddsi_serdata* from_ser_iov(const ddsi_sertype* sertype, ddsi_serdata_kind kind,
                           ddsrt_msg_iovlen_t parts, const ddsrt_iovec_t* part, size_t size) {
  std::string payload;
  for (std::size_t i = 0; i < static_cast<std::size_t>(parts) && payload.size() < size; ++i) {
    payload.append(static_cast<const char*>(part[i].iov_base),
                   std::min<std::size_t>(part[i].iov_len, size - payload.size()));
  }
  return received(sertype, kind, std::move(payload));
}

ddsi_serdata* from_keyhash(const ddsi_sertype* sertype, const ddsi_keyhash* keyhash) {
  KeyHash hash;
  std::memcpy(hash.data(), keyhash->value, hash.size());
  auto key = own(sertype).keys.recall(hash);
  if (!key) {
    return nullptr;
  }
  auto payload = std::make_shared<const std::string>(key_payload(*key, ByteOrder::little));
  return make_serdata(sertype, SDK_KEY, std::move(payload), instance_of(std::move(*key)));
}

// Only dds_write() of whole messages is called with a sample.
ddsi_serdata* from_sample(const ddsi_sertype* sertype, ddsi_serdata_kind kind, const void* sample) {
  const auto& message = *static_cast<const OutgoingMessage*>(sample);
  return make_serdata(sertype, kind, message.payload, message.instance);
}

void to_ser(const ddsi_serdata* serdata, size_t offset, size_t size, void* buffer) {
  std::memcpy(buffer, own(serdata).payload->data() + offset, size);
}

ddsi_serdata* to_ser_ref(const ddsi_serdata* serdata, size_t offset, size_t size,
                         ddsrt_iovec_t* part) {
  part->iov_base = const_cast<char*>(own(serdata).payload->data()) + offset;
  part->iov_len = size;
  return ddsi_serdata_ref(serdata);
}

void to_ser_unref(ddsi_serdata* serdata, const ddsrt_iovec_t* /*part*/) {
  ddsi_serdata_unref(serdata);
}

bool decode(const TypeSupport& type, const SerData& serdata, void* sample) {
  return type.deserialize(sample, serdata.payload->data(), serdata.size);
}

bool to_sample(const ddsi_serdata* serdata, void* sample, void** /*buffer*/, void* /*limit*/) {
  return decode(*own(serdata->type).type, own(serdata), sample);
}

ddsi_serdata* to_untyped(const ddsi_serdata* serdata) {
  auto* untyped = new SerData(serdata->type, SDK_KEY);
  untyped->type = nullptr;
  untyped->instance = own(serdata).instance;
  untyped->hash = serdata->hash;
  return untyped;
}

bool untyped_to_sample(const ddsi_sertype* sertype, const ddsi_serdata* serdata, void* sample,
                       void** /*buffer*/, void* /*limit*/) {
  return decode(*own(sertype).type, own(serdata), sample);
}

bool keys_are_equal(const ddsi_serdata* a, const ddsi_serdata* b) {
  return own(a).instance == own(b).instance || own(a).instance->key == own(b).instance->key;
}

std::uint32_t payload_size(const ddsi_serdata* serdata) {
  return static_cast<std::uint32_t>(own(serdata).size);
}

void free_serdata(ddsi_serdata* serdata) {
  delete static_cast<SerData*>(serdata);
}

size_t print(const ddsi_sertype* sertype, const ddsi_serdata* /*serdata*/, char* text,
             size_t size) {
  const int length =
      std::snprintf(text, size, "%s", sertype != nullptr ? sertype->type_name : "key");
  return length < 0 ? 0 : static_cast<size_t>(length);
}

// Every key of the contract can be longer than 16 bytes, so the hash is always the MD5.
void get_keyhash(const ddsi_serdata* serdata, ddsi_keyhash* keyhash, bool /*force_md5*/) {
  std::memcpy(keyhash->value, own(serdata).instance->hash.data(), sizeof keyhash->value);
}

constexpr ddsi_serdata_ops make_serdata_ops() {
  ddsi_serdata_ops ops{};
  ops.eqkey = keys_are_equal;
  ops.get_size = payload_size;
  ops.from_ser = from_ser;
  ops.from_ser_iov = from_ser_iov;
  ops.from_keyhash = from_keyhash;
  ops.from_sample = from_sample;
  ops.to_ser = to_ser;
  ops.to_ser_ref = to_ser_ref;
  ops.to_ser_unref = to_ser_unref;
  ops.to_sample = to_sample;
  ops.to_untyped = to_untyped;
  ops.untyped_to_sample = untyped_to_sample;
  ops.free = free_serdata;
  ops.print = print;
  ops.get_keyhash = get_keyhash;
  return ops;
}

constexpr ddsi_serdata_ops serdata_ops = make_serdata_ops();

void free_sertype(ddsi_sertype* sertype) {
  ddsi_sertype_fini(sertype);
  delete static_cast<SerType*>(sertype);
}

bool sertypes_are_equal(const ddsi_sertype* a, const ddsi_sertype* b) {
  return own(a).type == own(b).type && own(a).malformed == own(b).malformed;
}

std::uint32_t hash_of_sertype(const ddsi_sertype* sertype) {
  return static_cast<std::uint32_t>(std::hash<const TypeSupport*>{}(own(sertype).type));
}

// Cyclone DDS derives one type for each data representation; ours has one.
ddsi_sertype* derive_sertype(const ddsi_sertype* sertype,
                             dds_data_representation_id_t /*representation*/,
                             dds_type_consistency_enforcement_qospolicy_t /*consistency*/) {
  return const_cast<ddsi_sertype*>(sertype);
}

// Samples are made and freed by TypeSupport, never by Cyclone DDS.
void zero_samples(const ddsi_sertype* /*sertype*/, void* /*samples*/, size_t /*count*/) {}
void realloc_samples(void** /*samples*/, const ddsi_sertype* /*sertype*/, void* /*old*/,
                     size_t /*old_count*/, size_t /*count*/) {}
void free_samples(const ddsi_sertype* /*sertype*/, void** /*samples*/, size_t /*count*/,
                  dds_free_op_t /*operation*/) {}

constexpr ddsi_sertype_ops make_sertype_ops() {
  ddsi_sertype_ops ops{};
  ops.version = ddsi_sertype_v0;
  ops.free = free_sertype;
  ops.zero_samples = zero_samples;
  ops.realloc_samples = realloc_samples;
  ops.free_samples = free_samples;
  ops.equal = sertypes_are_equal;
  ops.hash = hash_of_sertype;
  ops.derive_sertype = derive_sertype;
  return ops;
}

constexpr ddsi_sertype_ops sertype_ops = make_sertype_ops();

} // namespace

KeyHash cyclone_dds_key_hash(const std::string& canonical_key) {
  KeyHash hash;
  ddsrt_md5_state_t state;
  ddsrt_md5_init(&state);
  ddsrt_md5_append(&state, reinterpret_cast<const ddsrt_md5_byte_t*>(canonical_key.data()),
                   static_cast<unsigned>(canonical_key.size()));
  ddsrt_md5_finish(&state, hash.data());
  return hash;
}

ddsi_sertype* make_cyclone_sertype(const TypeSupport& type,
                                   std::shared_ptr<MalformedMessages> malformed) {
  auto* sertype = new SerType(type, std::move(malformed));
  ddsi_sertype_init(sertype, type.name.c_str(), &sertype_ops, &serdata_ops, false);
  sertype->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return sertype;
}

void release_cyclone_sertype(ddsi_sertype* sertype) {
  ddsi_sertype_unref(sertype);
}

const ddsi_domaingv& domain_of(const ddsi_sertype& sertype) {
  return *static_cast<const ddsi_domaingv*>(ddsrt_atomic_ldvoidp(&sertype.gv));
}

bool read_cyclone_serdata(const TypeSupport& type, const ddsi_serdata* serdata, void* sample) {
  return decode(type, own(serdata), sample);
}

std::string_view payload_of(const ddsi_serdata* serdata) {
  return {own(serdata).payload->data(), own(serdata).size};
}

void release_cyclone_serdata(ddsi_serdata* serdata) {
  ddsi_serdata_unref(serdata);
}

} // namespace dyncal::bus
