#include "services/security/access_documents.hpp"

#include <fmt/format.h>

namespace dyncal::inline security {
namespace {

constexpr const char* schema =
    R"(<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" )"
    R"(xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_)";
// All that the specification has: which one a laboratory uses is no matter of access.
constexpr const char* every_domain =
    "<domains><id_range><min>0</min><max>230</max></id_range></domains>\n";

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    safe += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return safe;
}

std::string elements(const std::string& list, const std::string& one,
                     const std::vector<std::string>& texts) {
  std::string text = "<" + list + ">";
  for (const std::string& each : texts) {
    text += fmt::format("<{0}>{1}</{0}>", one, escaped(each));
  }
  return text + "</" + list + ">";
}

// Without partitions a rule would allow the empty one alone. One rule a group: Fast DDS 2.9 allows
// every topic of a rule in the partitions of all of them.
std::string rules(const std::string& what, const std::vector<TopicGroup>& groups) {
  std::string text;
  for (const TopicGroup& group : groups) {
    text += fmt::format("<allow_rule>\n{0}<{1}>{2}\n{3}</{1}>\n</allow_rule>\n", every_domain, what,
                        elements("topics", "topic", group.topics),
                        elements("partitions", "partition", group.partitions));
  }
  return text;
}

} // namespace

// The metadata of a message is all of it: its payload encrypted besides would cost each end a
// second key and cipher (decisions/25-secured-blocks.md).
std::string governance_text() {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
{}governance.xsd">
<domain_access_rules><domain_rule>
{}<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>ENCRYPT</discovery_protection_kind>
<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
<rtps_protection_kind>NONE</rtps_protection_kind>
<topic_access_rules><topic_rule>
<topic_expression>*</topic_expression>
<enable_discovery_protection>true</enable_discovery_protection>
<enable_liveliness_protection>true</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>ENCRYPT</metadata_protection_kind>
<data_protection_kind>NONE</data_protection_kind>
</topic_rule></topic_access_rules>
</domain_rule></domain_access_rules>
</dds>
)",
                     schema, every_domain);
}

std::string permissions_text(const std::string& subject, const Validity& validity,
                             SecurityRole role, const std::vector<std::string>& benches) {
  const RoleAccess access = access_of(role, benches);
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
{}permissions.xsd">
<permissions><grant name="{}">
<subject_name>{}</subject_name>
<validity><not_before>{}</not_before><not_after>{}</not_after></validity>
{}{}<default>DENY</default>
</grant></permissions>
</dds>
)",
                     schema, to_string(role), escaped(subject), utc_text(validity.begin),
                     utc_text(validity.end), rules("publish", access.written),
                     rules("subscribe", access.read));
}

std::vector<std::string> elements_called(const std::string& name, const std::string& text) {
  const std::string begin = "<" + name + ">";
  const std::string end = "</" + name + ">";
  std::vector<std::string> found;
  for (auto at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    at += begin.size();
    const auto until = text.find(end, at);
    if (until == std::string::npos) {
      break;
    }
    found.push_back(text.substr(at, until - at));
  }
  return found;
}

std::string utc_text(std::time_t time) {
  std::tm utc{};
  gmtime_r(&time, &utc);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec);
}

} // namespace dyncal::inline security
