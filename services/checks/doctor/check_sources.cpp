#include <cmath>
#include <map>

#include <fmt/format.h>

#include "services/checks/doctor/announced_elsewhere.hpp"
#include "services/checks/doctor/checks.hpp"
#include "services/checks/doctor/laboratory_view.hpp"
#include "services/checks/doctor/participant_text.hpp"
#include "services/contract/bench_file_origin.hpp"

namespace dyncal::inline checks::doctor {
namespace {

constexpr double full_buffer = 0.5;
// The rate of a status is counted over a second or so, in blocks.
constexpr double rate_tolerance_rel = 0.1;

using SourceKey = LaboratoryView::Key;
using network::Source;
using network::SourceState;

std::string name_of(const SourceKey& key) {
  return key.first + "/" + key.second;
}

std::string host_of(const Source& source) {
  return source.host.empty() ? "" : " on " + source.host;
}

// The sentence that the source gives itself, if it gives one.
std::string reason_of(const Source& source) {
  return source.message.empty() ? "" : ": " + source.message;
}

// A file is played, and a trigger comes, with a run.
bool waits_for_a_run(const Source& source) {
  return (source.description && source.description->driver == "file") ||
         (source.kind && is_triggered(*source.kind));
}

Finding check_state(const SourceKey& key, const Source& source) {
  const std::string subject = "source " + name_of(key) + host_of(source);
  switch (source.state) {
  case SourceState::unknown:
    return {Severity::error, "sources",
            subject + " has described itself, but no status comes; does its service still run?"};
  case SourceState::starting:
    if (waits_for_a_run(source)) {
      return {Severity::ok, "sources", subject + " waits for a run" + reason_of(source)};
    }
    return {Severity::warning, "sources",
            subject + " has received nothing yet" + reason_of(source)};
  case SourceState::running:
    return {Severity::ok, "sources",
            fmt::format("{} is running, {:.1f} samples a second, {} readers{}", subject,
                        source.rate_hz, source.matched_readers, reason_of(source))};
  case SourceState::silent:
    return {Severity::error, "sources",
            subject + " is silent; is its instrument on and connected?" + reason_of(source)};
  case SourceState::ended:
    return {Severity::ok, "sources",
            subject + " has come to its end, as a recording does" + reason_of(source)};
  case SourceState::failed:
    break;
  }
  return {Severity::error, "sources", subject + " has failed" + reason_of(source)};
}

void add_loss(const std::string& subject, std::uint64_t before, std::uint64_t now,
              const std::string& what, const std::string& advice, Findings& findings) {
  if (now > before) {
    findings.push_back(
        {Severity::error, "losses",
         fmt::format("{}: {} samples {} while I looked; {}", subject, now - before, what, advice)});
  } else if (now > 0) {
    findings.push_back({Severity::warning, "losses",
                        fmt::format("{}: {} samples {} since its service was started, none while I "
                                    "looked",
                                    subject, now, what)});
  }
}

Findings check_losses(const SourceKey& key, const Source& source) {
  Findings findings;
  const drivers::SampleCounts& before = source.first_counts;
  const drivers::SampleCounts& now = source.counts;
  const std::string subject = name_of(key) + host_of(source);
  add_loss(subject, before.lost_on_way, now.lost_on_way, "were lost between device and service",
           "look at the network between them, and at 'buffers' of that host", findings);
  add_loss(subject, before.lost_in_device, now.lost_in_device, "were lost in the device",
           "reported by the device: lower its rate or see its manual", findings);
  add_loss(subject, source.first_dropped_in_service, source.dropped_in_service,
           "were dropped because the network did not take them",
           "a reader hangs or the network is slower than the source", findings);
  if (source.buffer_fill > full_buffer) {
    findings.push_back({Severity::warning, "losses",
                        fmt::format("{}: its buffer is {:.0f} % full; a reader hangs or the "
                                    "network is slower than the source",
                                    subject, source.buffer_fill * 100.0)});
  }
  return findings;
}

Findings check_twins(const SourceKey& key, const Source& source, const LaboratoryView& view) {
  const bool take_turns = source.turns.twins();
  if (!take_turns && source.services.size() < 2) {
    return {};
  }
  std::vector<std::string> who(source.services.begin(), source.services.end());
  if (const auto senders = view.senders.find(key);
      who.size() < 2 && senders != view.senders.end()) {
    who.clear(); // the newest description alone has come
    for (const std::string& id : senders->second) {
      who.push_back(participant_text(view, id));
    }
  }
  return {{take_turns ? Severity::error : Severity::warning, "twins",
           fmt::format("two services publish source {}{}{}; end one of them, or give it another "
                       "name",
                       name_of(key), who.empty() ? "" : ": ", fmt::join(who, " and "))}};
}

// Frequencies are held against half of the stated rate before a run.
Findings check_rate(const SourceKey& key, const Source& source, const SourceSettings& settings) {
  const bool is_running = source.state == SourceState::running;
  const double stated_hz = settings.nominal_rate_hz.value_or(0.0);
  const double rate_hz = is_running ? source.rate_hz : 0.0;
  if (!(stated_hz > 0.0) || !(rate_hz > 0.0) ||
      std::abs(rate_hz / stated_hz - 1.0) < rate_tolerance_rel) {
    return {};
  }
  return {
      {Severity::warning, "bench file",
       fmt::format("source {} sends {:.4g} samples a second, but its nominal_rate_hz is {:.6g}: "
                   "'dyncal check' holds the frequencies against that",
                   name_of(key), rate_hz, stated_hz)}};
}

// Against the file at hand.
Findings check_against(const BenchFile& bench, const LaboratoryView& view) {
  Findings findings;
  for (const SourceSettings& settings : bench.sources) {
    const SourceKey key{bench.bench, settings.name};
    const auto found = view.sources.find(key);
    if (found == view.sources.end()) {
      const std::string elsewhere = announced_elsewhere(view);
      findings.push_back({Severity::error, "bench file",
                          fmt::format("source {} of {} is not on the network; is its service "
                                      "running with this bench file, in DDS domain {}?{}{}",
                                      name_of(key), bench.path.string(), view.domain,
                                      elsewhere.empty() ? "" : " ", elsewhere)});
      continue;
    }
    append(findings, check_rate(key, found->second, settings));
    const Source& source = found->second;
    if (const auto difference =
            settings_difference(source.bench_file.settings, settings.origin.settings)) {
      findings.push_back({Severity::error, "bench file",
                          refusal(*difference, key.first, key.second, source.host)});
    } else if (!source.bench_file.sha256.empty() && source.bench_file.sha256 != bench.sha256) {
      findings.push_back({Severity::ok, "bench file",
                          fmt::format("the service of {}{} has read another bench file, which says "
                                      "the same of this source",
                                      name_of(key), host_of(source))});
    }
  }
  if (findings.empty()) {
    findings.push_back({Severity::ok, "bench file",
                        fmt::format("all sources of {} are there, and their services have read "
                                    "this file",
                                    bench.path.string())});
  }
  return findings;
}

// Services of one bench against each other.
Findings check_files_of_benches(const LaboratoryView& view) {
  std::map<std::string, std::map<std::string, std::string>> files; // bench -> sha256 -> source
  for (const auto& [key, source] : view.sources) {
    if (!source.bench_file.sha256.empty()) {
      files[key.first].emplace(source.bench_file.sha256, name_of(key));
    }
  }
  Findings findings;
  for (const auto& [bench, sources] : files) {
    if (sources.size() > 1) {
      findings.push_back(
          {Severity::warning, "bench file",
           fmt::format("the services of bench {} have read different bench files "
                       "(those of {} and {}); restart them with the same",
                       bench, sources.begin()->second, std::next(sources.begin())->second)});
    }
  }
  return findings;
}

} // namespace

Findings check_sources(const LaboratoryView& view, const std::optional<BenchFile>& bench) {
  Findings findings;
  Findings losses;
  for (const auto& [key, source] : view.sources) {
    findings.push_back(check_state(key, source));
    append(losses, check_losses(key, source));
    append(losses, check_twins(key, source, view));
  }
  append(losses, check_writers(view));
  if (findings.empty()) {
    findings.push_back({Severity::warning, "sources", "no source is there"});
  } else if (losses.empty()) {
    losses.push_back({Severity::ok, "losses", "no source has lost anything"});
  }
  append(findings, losses);
  append(findings, check_files_of_benches(view));
  if (bench) {
    append(findings, check_against(*bench, view));
  }
  return findings;
}

} // namespace dyncal::inline checks::doctor
