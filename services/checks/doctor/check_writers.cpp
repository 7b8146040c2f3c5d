#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "services/checks/doctor/participant_text.hpp"
#include "services/contract/source_kind.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using Place = std::pair<std::string, std::string>; // topic, partition

// Of a source of any kind.
bool is_of_samples(const std::string& topic) {
  constexpr std::array kinds{SourceKind::dau, SourceKind::acs, SourceKind::dso, SourceKind::tss,
                             SourceKind::can};
  return std::ranges::any_of(kinds, [&](SourceKind kind) { return topic == sample_topic(kind); });
}

} // namespace

Findings check_writers(const LaboratoryView& view) {
  std::map<std::string, std::set<std::string>> described; // by partition, the participants
  std::map<Place, std::set<std::string>> writing;
  for (const bus::DiscoveredEndpoint& one : view.discovery.endpoints) {
    if (one.kind != bus::EndpointKind::writer) {
      continue;
    }
    for (const std::string& partition : one.partitions) {
      if (one.topic == bus::topics::source_description.name) {
        described[partition].insert(one.participant);
      } else if (is_of_samples(one.topic)) {
        writing[{one.topic, partition}].insert(one.participant);
      }
    }
  }
  Findings findings;
  for (const auto& [place, participants] : writing) {
    for (const std::string& id : participants) {
      if (!described[place.second].contains(id)) {
        findings.push_back(
            {Severity::error, "twins",
             fmt::format("{} writes samples of bench {} (topic {}) and describes no source: it "
                         "sends in the name of another program; end it",
                         participant_text(view, id), place.second, place.first)});
      }
    }
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
