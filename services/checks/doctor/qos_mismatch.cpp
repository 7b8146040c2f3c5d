#include "services/checks/doctor/qos_mismatch.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using bus::AccessScope;
using bus::DestinationOrder;
using bus::DiscoveredEndpoint;
using bus::Liveliness;

const char* name_of(Liveliness liveliness) {
  return per_enumerator(liveliness, {"AUTOMATIC", "MANUAL_BY_PARTICIPANT", "MANUAL_BY_TOPIC"});
}

const char* name_of(AccessScope scope) {
  return per_enumerator(scope, {"INSTANCE", "TOPIC", "GROUP"});
}

const char* name_of(DestinationOrder order) {
  return order == DestinationOrder::by_source ? "BY_SOURCE_TIMESTAMP" : "BY_RECEPTION_TIMESTAMP";
}

std::string name_of(int representation) {
  switch (representation) {
  case 0:
    return "XCDR1";
  case 1:
    return "XML";
  case 2:
    return "XCDR2";
  default:
    return fmt::format("number {}", representation);
  }
}

std::string time_text(double seconds) {
  return std::isinf(seconds) ? "infinite" : fmt::format("{:.6g} s", seconds);
}

class Mismatches {
public:
  void add(bool match, const char* policy, const std::string& asked, const std::string& offered) {
    if (!match) {
      found_.push_back(
          fmt::format("{}: the reader asks for {}, the writer offers {}", policy, asked, offered));
    }
  }
  // Of times the writer has to keep the reader's.
  void add_time(const char* policy, double asked_s, double offered_s) {
    add(offered_s <= asked_s, policy, "at most " + time_text(asked_s), time_text(offered_s));
  }
  // Of kinds that are ordered.
  template <class Kind>
  void add_kind(const char* policy, Kind asked, Kind offered) {
    add(offered >= asked, policy, name_of(asked), name_of(offered));
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(found_); }

private:
  std::vector<std::string> found_;
};

void add_representation(const DiscoveredEndpoint& writer, const DiscoveredEndpoint& reader,
                        Mismatches& mismatches) {
  const int offered = writer.representations.empty() ? 0 : writer.representations.front();
  const std::vector<int> asked =
      reader.representations.empty() ? std::vector<int>{0} : reader.representations;
  std::vector<std::string> names;
  for (const int representation : asked) {
    names.push_back(name_of(representation));
  }
  mismatches.add(std::ranges::find(asked, offered) != asked.end(), "data representation",
                 fmt::format("{}", fmt::join(names, " or ")), name_of(offered));
}

} // namespace

std::vector<std::string> qos_mismatches(const DiscoveredEndpoint& writer,
                                        const DiscoveredEndpoint& reader) {
  Mismatches mismatches;
  mismatches.add(writer.reliable || !reader.reliable, "reliability", "RELIABLE", "BEST_EFFORT");
  mismatches.add(writer.transient_local || !reader.transient_local, "durability", "TRANSIENT_LOCAL",
                 "VOLATILE");
  const auto ownership = [](bool exclusive) { return exclusive ? "EXCLUSIVE" : "SHARED"; };
  mismatches.add(writer.exclusive_ownership == reader.exclusive_ownership, "ownership",
                 ownership(reader.exclusive_ownership), ownership(writer.exclusive_ownership));
  mismatches.add_time("deadline", reader.deadline_s, writer.deadline_s);
  mismatches.add_time("latency budget", reader.latency_budget_s, writer.latency_budget_s);
  mismatches.add_kind("liveliness", reader.liveliness, writer.liveliness);
  mismatches.add_time("lease of liveliness", reader.lease_s, writer.lease_s);
  mismatches.add_kind("presentation", reader.access_scope, writer.access_scope);
  mismatches.add(writer.coherent_access || !reader.coherent_access, "presentation",
                 "coherent access", "none");
  mismatches.add(writer.ordered_access || !reader.ordered_access, "presentation", "ordered access",
                 "none");
  mismatches.add_kind("destination order", reader.destination_order, writer.destination_order);
  add_representation(writer, reader, mismatches);
  return mismatches.take();
}

} // namespace dyncal::inline checks::doctor
