#include "services/contract/topic_access.hpp"

#include <algorithm>

#include "services/contract/topics.hpp"

namespace dyncal::inline contract {
namespace {

namespace topics = bus::topics;
using enum SecurityRole;
using Roles = std::vector<SecurityRole>;

constexpr const char* every_partition = "*";
constexpr const char* partition_of_all_benches = "all-benches";

Roles operator+(Roles roles, const Roles& more) {
  roles.insert(roles.end(), more.begin(), more.end());
  return roles;
}

bool holds(const Roles& roles, SecurityRole role) {
  return std::ranges::find(roles, role) != roles.end();
}

std::vector<TopicAccess> make_topic_access() {
  const Roles lookers{analysis, conductor, recorder, web, watcher};
  const Roles services{source, analysis, guard, recorder, web};
  const Roles missers{analysis, conductor, recorder}; // who may have been away
  const Roles askers{conductor, web, watcher};        // who ask for the clocks of others
  const Roles instruments{source};
  const auto bench = TopicPlace::bench;
  const auto laboratory = TopicPlace::laboratory;
  return {
      {topics::source_description, bench, instruments, lookers + Roles{source, guard}},
      {topics::source_status, bench, instruments, lookers + instruments},
      {topics::dau_samples, bench, instruments, lookers},
      {topics::acs_samples, bench, instruments, lookers + Roles{guard}},
      {topics::can_samples, bench, instruments, lookers},
      {topics::dso_record, bench, instruments, lookers},
      {topics::tss_record, bench, instruments, lookers},
      {topics::acs_step, bench, instruments, lookers},
      {topics::measurement, bench, {conductor}, lookers + Roles{source, guard}},
      {topics::excitation, bench, {conductor}, lookers + Roles{source, guard}},
      {topics::calibration_result, bench, {analysis}, lookers},
      {topics::transfer_function, bench, {analysis}, lookers},
      {topics::sample_clock_report, bench, {analysis}, lookers},
      {topics::service_status, bench, {analysis, guard}, lookers},
      // Of a run that keeps a recording, the conductor is its recorder.
      {topics::recorder_status, bench, {conductor, recorder}, lookers},
      {topics::command, bench, {analysis, web}, lookers + instruments},
      {topics::catch_up_request, bench, missers, lookers + instruments},
      {topics::catch_up_samples, bench, instruments, missers},
      {topics::catch_up_records, bench, instruments, missers},
      {topics::clock_request, laboratory, askers, services},
      {topics::clock_answer, laboratory, services, askers},
      {topics::link_probe, laboratory, askers, services},
      {topics::link_echo, laboratory, services, askers},
  };
}

std::vector<std::string> partitions_at(TopicPlace place, bool everywhere,
                                       const std::vector<std::string>& benches) {
  if (place == TopicPlace::laboratory) {
    return {partition_of_all_benches};
  }
  if (everywhere) {
    return {every_partition};
  }
  std::vector<std::string> partitions;
  for (const std::string& bench : benches) {
    partitions.push_back(bench);
    partitions.push_back(bench + "/*"); // its runs, and who catches up
  }
  return partitions;
}

void add(std::vector<TopicGroup>& groups, const char* topic, std::vector<std::string> partitions) {
  const auto same = std::ranges::find(groups, partitions, &TopicGroup::partitions);
  if (same != groups.end()) {
    same->topics.emplace_back(topic);
  } else {
    groups.push_back({{topic}, std::move(partitions)});
  }
}

} // namespace

const std::vector<TopicAccess>& topic_access() {
  static const std::vector<TopicAccess> table = make_topic_access();
  return table;
}

const std::vector<SecurityRole>& security_roles() {
  static const std::vector<SecurityRole> roles{source,   analysis, guard,  conductor,
                                               recorder, web,      watcher};
  return roles;
}

const char* to_string(SecurityRole role) {
  switch (role) {
  case source:
    return "source";
  case analysis:
    return "analysis";
  case guard:
    return "guard";
  case conductor:
    return "operator";
  case recorder:
    return "recorder";
  case web:
    return "web";
  case watcher:
    break;
  }
  return "watcher";
}

std::optional<SecurityRole> parse_security_role(std::string_view name) {
  for (const SecurityRole role : security_roles()) {
    if (name == to_string(role)) {
      return role;
    }
  }
  return std::nullopt;
}

RoleAccess access_of(SecurityRole role, const std::vector<std::string>& benches) {
  RoleAccess access;
  for (const TopicAccess& row : topic_access()) {
    if (holds(row.writers, role)) {
      add(access.written, row.topic, partitions_at(row.place, !is_of_a_bench(role), benches));
    }
    if (holds(row.readers, role)) {
      add(access.read, row.topic, partitions_at(row.place, reads_all_benches(role), benches));
    }
  }
  return access;
}

} // namespace dyncal::inline contract
