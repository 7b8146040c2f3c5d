#include "services/contract/sample_topic.hpp"

#include "services/contract/topics.hpp"

namespace dyncal::bus {

const char* sample_topic(wire::SourceKind kind) {
  switch (kind) {
  case wire::SOURCE_DAU:
    return topics::dau_samples;
  case wire::SOURCE_CAN:
    return topics::can_samples;
  case wire::SOURCE_DSO:
    return topics::dso_record;
  case wire::SOURCE_TSS:
    return topics::tss_record;
  case wire::SOURCE_ACS:
    break;
  }
  return topics::acs_samples;
}

bool is_triggered(wire::SourceKind kind) {
  return kind == wire::SOURCE_DSO || kind == wire::SOURCE_TSS;
}

} // namespace dyncal::bus
