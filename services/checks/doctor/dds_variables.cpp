#include "services/checks/doctor/dds_variables.hpp"

#include <array>
#include <cstdlib>
#include <filesystem>

#include <fmt/core.h>

#include "services/checks/doctor/host_view.hpp"
#include "services/checks/doctor/laboratory_view.hpp"

namespace dyncal::inline checks::doctor {
namespace {

struct Variable {
  const char* name;
  const char* vendor; // that heeds it, as --dds names it; empty: dyncal does not
  const char* effect;
};

constexpr const char* profile = "its default participant profile, if it has one, stands in place "
                                "of --peer, --interface and --no-multicast";
constexpr std::array variables{
    Variable{"ROS_DISCOVERY_SERVER", "fastdds",
             "Fast DDS then finds others by that server alone, neither by multicast nor by --peer"},
    Variable{"FASTRTPS_DEFAULT_PROFILES_FILE", "fastdds", profile},
    Variable{"FASTDDS_DEFAULT_PROFILES_FILE", "fastdds", profile},
    Variable{"CYCLONEDDS_URI", "cyclonedds",
             "its settings go before those of dyncal and are added to --peer and --interface"},
    Variable{"ROS_DOMAIN_ID", "", "dyncal does not heed it: give --domain"},
    Variable{"ROS_LOCALHOST_ONLY", "", "dyncal does not heed it: give --interface lo"},
    Variable{"ROS_AUTOMATIC_DISCOVERY_RANGE", "",
             "dyncal does not heed it: give --interface, or --no-multicast and --peer"},
    Variable{"ROS_STATIC_PEERS", "", "dyncal does not heed it: give --peer"},
};
constexpr std::array profile_files{"DEFAULT_FASTRTPS_PROFILES.xml", "DEFAULT_FASTDDS_PROFILES.xml"};

Finding about(const Variable& variable, const std::string& name, const std::string& what,
              const LaboratoryView& view) {
  const bool may_be_why = view.own.dds == variable.vendor && view.programs.empty();
  const std::string advice =
      *variable.vendor == '\0'
          ? ""
          : fmt::format("; without it, or with it for every program of {}, they are alike",
                        variable.vendor);
  return {may_be_why ? Severity::warning : Severity::note, "variables",
          fmt::format("{} {}: {}{}", name, what, variable.effect, advice)};
}

} // namespace

std::map<std::string, std::string> dds_variables() {
  std::map<std::string, std::string> found;
  for (const Variable& variable : variables) {
    const char* value = std::getenv(variable.name);
    if (value != nullptr && *value != '\0') {
      found[variable.name] = value;
    }
  }
  for (const char* file : profile_files) {
    std::error_code error;
    if (std::filesystem::exists(file, error)) {
      found[file] = std::filesystem::absolute(file, error).string();
    }
  }
  return found;
}

Findings check_variables(const LaboratoryView& view, const HostView& host) {
  Findings findings;
  for (const Variable& variable : variables) {
    if (const auto found = host.dds_variables.find(variable.name);
        found != host.dds_variables.end()) {
      findings.push_back(
          about(variable, variable.name, fmt::format("is set here to '{}'", found->second), view));
    }
  }
  for (const char* file : profile_files) {
    if (const auto found = host.dds_variables.find(file); found != host.dds_variables.end()) {
      findings.push_back(about({file, "fastdds", profile}, found->second,
                               "is in the working directory, where Fast DDS reads it", view));
    }
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
