#include <fnmatch.h>

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "services/bus/host_clocks/clock_messages.hpp"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "services/checks/doctor/participant_text.hpp"
#include "services/checks/doctor/qos_mismatch.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using bus::DiscoveredEndpoint;
using bus::EndpointKind;

bool is_of_the_contract(const std::string& topic) {
  namespace topics = bus::topics;
  static const std::set<std::string> names{topics::source_description,
                                           topics::source_status,
                                           topics::dau_samples,
                                           topics::acs_samples,
                                           topics::can_samples,
                                           topics::dso_record,
                                           topics::tss_record,
                                           topics::acs_step,
                                           topics::measurement,
                                           topics::excitation,
                                           topics::calibration_result,
                                           topics::transfer_function,
                                           topics::sample_clock_report,
                                           topics::service_status,
                                           topics::recorder_status,
                                           topics::command,
                                           topics::catch_up_request,
                                           topics::catch_up_samples,
                                           topics::catch_up_records,
                                           topics::clock_request,
                                           topics::clock_answer,
                                           topics::link_probe,
                                           topics::link_echo};
  return names.contains(topic);
}

bool is_pattern(const std::string& partition) {
  return partition.find_first_of("*?[") != std::string::npos;
}

bool share_a_partition(const DiscoveredEndpoint& writer, const DiscoveredEndpoint& reader) {
  return std::ranges::any_of(writer.partitions, [&](const std::string& first) {
    return std::ranges::any_of(reader.partitions, [&](const std::string& second) {
      return partitions_match(first, second);
    });
  });
}

std::string partition_text(const DiscoveredEndpoint& endpoint) {
  std::string text;
  for (const std::string& partition : endpoint.partitions) {
    text += (text.empty() ? "'" : ", '") + partition + "'";
  }
  return text;
}

// Why a writer and a reader of one topic and partition do not match; empty if they do.
std::string mismatch(const DiscoveredEndpoint& writer, const DiscoveredEndpoint& reader) {
  if (writer.type != reader.type) {
    return fmt::format("type: the writer has '{}', the reader '{}'", writer.type, reader.type);
  }
  return fmt::format("{}", fmt::join(qos_mismatches(writer, reader), ", and by their "));
}

Findings mismatches(const LaboratoryView& view) {
  const auto& endpoints = view.discovery.endpoints;
  std::set<std::string> sentences; // each once, however many endpoints a program has
  for (const DiscoveredEndpoint& writer : endpoints) {
    for (const DiscoveredEndpoint& reader : endpoints) {
      const bool meet = writer.kind == EndpointKind::writer &&
                        reader.kind == EndpointKind::reader && writer.topic == reader.topic &&
                        is_of_the_contract(writer.topic) && share_a_partition(writer, reader);
      const std::string why = meet ? mismatch(writer, reader) : "";
      if (!why.empty()) {
        sentences.insert(fmt::format("topic {}: the writer of {} and the reader of {} do not match "
                                     "by their {}; use the QoS profile of idl/README.md",
                                     writer.topic, participant_text(view, writer.participant),
                                     participant_text(view, reader.participant), why));
      }
    }
  }
  Findings findings;
  for (const std::string& sentence : sentences) {
    findings.push_back({Severity::error, "endpoints", sentence});
  }
  return findings;
}

// Endpoints in a partition that is no bench of this laboratory, where the other side is elsewhere.
Findings lost_partitions(const LaboratoryView& view, const std::set<std::string>& benches) {
  const auto& endpoints = view.discovery.endpoints;
  std::set<std::string> sentences;
  for (const DiscoveredEndpoint& endpoint : endpoints) {
    const bool known = std::ranges::any_of(endpoint.partitions, [&](const std::string& partition) {
      return is_pattern(partition) || benches.contains(partition) ||
             benches.contains(partition.substr(0, partition.rfind('/'))); // of a run
    });
    if (known || !is_of_the_contract(endpoint.topic)) {
      continue;
    }
    const auto is_other_side = [&](const DiscoveredEndpoint& other) {
      return other.topic == endpoint.topic && other.kind != endpoint.kind;
    };
    const auto other = std::ranges::find_if(endpoints, is_other_side);
    const bool matched = std::ranges::any_of(endpoints, [&](const DiscoveredEndpoint& one) {
      return is_other_side(one) && share_a_partition(endpoint, one);
    });
    if (other == endpoints.end() || matched) {
      continue;
    }
    const bool reads = endpoint.kind == EndpointKind::reader;
    sentences.insert(fmt::format(
        "topic {}: the {} of {} is in partition {}, where no {} is, but {} is in {}; {}",
        endpoint.topic, reads ? "reader" : "writer", participant_text(view, endpoint.participant),
        partition_text(endpoint), reads ? "writer" : "reader",
        participant_text(view, other->participant), partition_text(*other),
        reads ? "ask for the name of the bench, or '*' for all"
              : "write in the partition of the bench"));
  }
  Findings findings;
  for (const std::string& sentence : sentences) {
    findings.push_back({Severity::warning, "endpoints", sentence});
  }
  return findings;
}

} // namespace

bool partitions_match(const std::string& first, const std::string& second) {
  if (first == second) {
    return !is_pattern(first);
  }
  if (is_pattern(first) == is_pattern(second)) {
    return false;
  }
  return is_pattern(first) ? fnmatch(first.c_str(), second.c_str(), 0) == 0
                           : fnmatch(second.c_str(), first.c_str(), 0) == 0;
}

Findings check_endpoints(const LaboratoryView& view, const std::vector<std::string>& benches) {
  std::set<std::string> known(benches.begin(), benches.end());
  known.insert(all_benches_partition);
  for (const auto& [key, source] : view.sources) {
    known.insert(key.first);
  }
  Findings findings = mismatches(view);
  append(findings, lost_partitions(view, known));
  if (findings.empty()) {
    const auto of_contract =
        std::ranges::count_if(view.discovery.endpoints, [](const DiscoveredEndpoint& one) {
          return is_of_the_contract(one.topic);
        });
    findings.push_back({Severity::ok, "endpoints",
                        fmt::format("{} writers and readers of {} participants, none that should "
                                    "match and does not",
                                    of_contract, view.discovery.participants.size())});
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
