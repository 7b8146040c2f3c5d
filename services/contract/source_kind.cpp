#include "services/contract/source_kind.hpp"

#include "services/base/per_enumerator.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline contract {

const char* to_string(SourceKind kind) {
  return per_enumerator(kind, {"dau", "acs", "dso", "tss", "can"});
}

wire::SourceKind to_wire(SourceKind kind) {
  return per_enumerator(kind, {wire::SOURCE_DAU, wire::SOURCE_ACS, wire::SOURCE_DSO,
                               wire::SOURCE_TSS, wire::SOURCE_CAN});
}

SourceKind from_wire(wire::SourceKind kind) {
  return per_enumerator(
      kind, {SourceKind::dau, SourceKind::acs, SourceKind::dso, SourceKind::tss, SourceKind::can},
      SourceKind::acs);
}

bool is_triggered(SourceKind kind) {
  return kind == SourceKind::dso || kind == SourceKind::tss;
}

const char* sample_topic(SourceKind kind) {
  namespace topics = bus::topics;
  return per_enumerator(kind, {topics::dau_samples.name, topics::acs_samples.name,
                               topics::dso_record.name, topics::tss_record.name,
                               topics::can_samples.name});
}

} // namespace dyncal::inline contract
