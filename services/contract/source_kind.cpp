#include "services/contract/source_kind.hpp"

#include "services/contract/topics.hpp"

namespace dyncal::inline contract {

const char* to_string(SourceKind kind) {
  switch (kind) {
  case SourceKind::dau:
    return "dau";
  case SourceKind::acs:
    return "acs";
  case SourceKind::dso:
    return "dso";
  case SourceKind::tss:
    return "tss";
  case SourceKind::can:
    return "can";
  }
  return "acs";
}

wire::SourceKind to_wire(SourceKind kind) {
  switch (kind) {
  case SourceKind::dau:
    return wire::SOURCE_DAU;
  case SourceKind::acs:
    return wire::SOURCE_ACS;
  case SourceKind::dso:
    return wire::SOURCE_DSO;
  case SourceKind::tss:
    return wire::SOURCE_TSS;
  case SourceKind::can:
    return wire::SOURCE_CAN;
  }
  return wire::SOURCE_ACS;
}

SourceKind from_wire(wire::SourceKind kind) {
  switch (kind) {
  case wire::SOURCE_DAU:
    return SourceKind::dau;
  case wire::SOURCE_DSO:
    return SourceKind::dso;
  case wire::SOURCE_TSS:
    return SourceKind::tss;
  case wire::SOURCE_CAN:
    return SourceKind::can;
  default:
    return SourceKind::acs;
  }
}

bool is_triggered(SourceKind kind) {
  return kind == SourceKind::dso || kind == SourceKind::tss;
}

const char* sample_topic(SourceKind kind) {
  switch (kind) {
  case SourceKind::dau:
    return bus::topics::dau_samples;
  case SourceKind::acs:
    return bus::topics::acs_samples;
  case SourceKind::dso:
    return bus::topics::dso_record;
  case SourceKind::tss:
    return bus::topics::tss_record;
  case SourceKind::can:
    return bus::topics::can_samples;
  }
  return bus::topics::acs_samples;
}

} // namespace dyncal::inline contract
