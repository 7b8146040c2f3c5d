#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {
namespace {

// "Cyclone DDS" as --dds names it.
std::string option_of(const std::string& vendor) {
  std::string option;
  for (const char letter : vendor) {
    if (letter != ' ') {
      option += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
  }
  return option;
}

} // namespace

Findings check_vendors(const LaboratoryView& view, bool is_said_to_be_one) {
  std::set<std::string> others;
  for (const bus::DiscoveredParticipant& one : view.discovery.participants) {
    if (option_of(one.vendor) != view.own.dds) {
      others.insert(fmt::format("{} ({})", one.name.empty() ? "a program" : one.name, one.vendor));
    }
  }
  if (is_said_to_be_one && !others.empty()) {
    return {{Severity::warning, "vendors",
             fmt::format("with --vendors same, but not all have {}: {} may miss packets that are "
                         "longer than it receives; start every program without --vendors same",
                         view.own.dds, fmt::join(others, ", "))}};
  }
  if (view.discovery.participants.empty() || !others.empty()) {
    return {};
  }
  return {{Severity::ok, "vendors",
           fmt::format("all {} participants have {}{}", view.discovery.participants.size() + 1,
                       view.own.dds,
                       is_said_to_be_one
                           ? ""
                           : ": --vendors same would do, which is faster on one computer and "
                             "where frames are longer than those of Ethernet")}};
}

} // namespace dyncal::inline checks::doctor
