#include "services/checks/doctor/report.hpp"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/printable_text.hpp"

namespace dyncal::inline checks::doctor {
namespace {

using nlohmann::ordered_json;

ordered_json programs_json(const LaboratoryView& view) {
  ordered_json programs = ordered_json::array();
  for (const DiscoveredProgram& program : view.programs) {
    programs.push_back({{"program", program.identity.program},
                        {"host", program.identity.host},
                        {"process_id", program.identity.process_id},
                        {"software", program.identity.software},
                        {"dds", program.identity.dds},
                        {"contract_version", program.contract_version},
                        {"packets_refused", program.packets_refused},
                        {"packets_refused_from", program.packets_refused_from}});
  }
  return programs;
}

ordered_json clocks_json(const LaboratoryView& view) {
  ordered_json clocks = ordered_json::array();
  for (const HostClock& host : view.clocks) {
    clocks.push_back(
        {{"host", host.host}, {"offset_s", host.clock.offset_s}, {"bound_s", host.clock.bound_s}});
  }
  return clocks;
}

ordered_json losses_json(const LaboratoryView& view) {
  ordered_json losses = ordered_json::array();
  for (const LinkLoss& loss : view.losses) {
    const auto lost = lost_part(loss);
    losses.push_back({{"program", loss.identity.program},
                      {"host", loss.identity.host},
                      {"process_id", loss.identity.process_id},
                      {"answers_probes", loss.answers_probes},
                      {"probes", loss.sent},
                      {"echoes", loss.echoed},
                      {"lost_percent", lost ? ordered_json(*lost * 100.0) : ordered_json()}});
  }
  return losses;
}

ordered_json sources_json(const LaboratoryView& view) {
  ordered_json sources = ordered_json::array();
  for (const auto& [key, source] : view.sources) {
    ordered_json one{{"bench", key.first}, {"source", key.second}};
    if (source.description) {
      one["host"] = source.host;
      one["process_id"] = source.process_id;
      one["device"] = source.description->device;
      one["serial"] = source.description->serial;
      one["software"] = source.software;
      one["bench_file_sha256"] = source.bench_file.sha256;
    }
    if (source.state != network::SourceState::unknown) {
      one["state"] = network::to_string(source.state);
      one["message"] = source.message;
      one["rate_hz"] = source.rate_hz;
      one["received"] = source.counts.received;
      one["lost_in_device"] = source.counts.lost_in_device;
      one["lost_in_transit"] = source.counts.lost_on_way;
      one["duplicates"] = source.counts.duplicates;
      one["rejected"] = source.counts.rejected;
      one["dropped_in_service"] = source.dropped_in_service;
      one["buffer_fill"] = source.buffer_fill;
      one["matched_readers"] = source.matched_readers;
    }
    sources.push_back(std::move(one));
  }
  return sources;
}

ordered_json participants_json(const LaboratoryView& view) {
  ordered_json participants = ordered_json::array();
  for (const bus::DiscoveredParticipant& one : view.discovery.participants) {
    const auto endpoints =
        std::ranges::count(view.discovery.endpoints, one.id, &bus::DiscoveredEndpoint::participant);
    ordered_json participant{
        {"name", one.name}, {"vendor", one.vendor}, {"id", one.id}, {"endpoints", endpoints}};
    if (view.announced_by_multicast) {
      participant["by_multicast"] = view.announced_by_multicast->contains(one.id);
    }
    participants.push_back(std::move(participant));
  }
  return participants;
}

// As scripts that watch know it: what has to be mended is a problem.
const char* word_of(Severity severity) {
  return severity == Severity::error ? "problem" : to_string(severity);
}

// Every text, regardless of who wrote it.
void shorten(ordered_json& json) {
  if (json.is_string()) {
    json = one_line(json.get_ref<const std::string&>());
  }
  if (json.is_structured()) {
    for (ordered_json& part : json) {
      shorten(part);
    }
  }
}

} // namespace

std::string as_text(const Findings& findings) {
  std::string text;
  int warnings = 0;
  int problems = 0;
  for (const Finding& finding : findings) {
    const bool ok = finding.severity == Severity::ok;
    warnings += finding.severity == Severity::warning ? 1 : 0;
    problems += finding.severity == Severity::error ? 1 : 0;
    text += fmt::format("{:<8} {:<11} {}\n",
                        ok                                      ? "ok"
                        : finding.severity == Severity::note    ? "note"
                        : finding.severity == Severity::warning ? "WARNING"
                                                                : "PROBLEM",
                        finding.subject, one_line(finding.sentence));
  }
  return text + (warnings + problems == 0
                     ? "nothing is wrong\n"
                     : fmt::format("{} problem{}, {} warning{}\n", problems,
                                   problems == 1 ? "" : "s", warnings, warnings == 1 ? "" : "s"));
}

ordered_json as_json(const Findings& findings, const LaboratoryView& view) {
  ordered_json list = ordered_json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"check", finding.subject},
                    {"severity", word_of(finding.severity)},
                    {"sentence", finding.sentence}});
  }
  ordered_json all{{"status", word_of(worst(findings))},
                   {"domain", view.domain},
                   {"seconds", view.seconds},
                   {"host", view.own.host},
                   {"software", view.own.software},
                   {"findings", std::move(list)},
                   {"programs", programs_json(view)},
                   {"clocks", clocks_json(view)},
                   {"losses", losses_json(view)},
                   {"sources", sources_json(view)},
                   {"participants", participants_json(view)}};
  shorten(all);
  return all;
}

} // namespace dyncal::inline checks::doctor
