#include <algorithm>
#include <set>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/base/nearest_name.hpp"
#include "services/checks/bench_check/checks.hpp"
#include "services/contract/quantity.hpp"
#include "services/contract/role_quantities.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

struct Role {
  KeyPath key;
  std::optional<std::size_t> entry;
  ChannelName channel;
};

std::vector<Role> roles_of(const MethodSettings& method) {
  const bool by_series = method.kind == EvaluationMethod::series_timestamping;
  std::vector<Role> roles{{{"method", "reference"}, {}, method.reference},
                          {{"method", "sync_acs"}, {}, method.sync_acs},
                          {{"method", by_series ? "sync_dso" : "sync_dau"}, {}, method.sync_dau}};
  if (method.temperature) {
    roles.push_back({{"method", "temperature"}, {}, *method.temperature});
  }
  for (std::size_t i = 0; i < method.dut.size(); ++i) {
    roles.push_back({{"method", "dut"}, i, method.dut[i]});
  }
  return roles;
}

const drivers::ChannelDescription* find_channel(const SourceView& source, const std::string& name) {
  const auto& channels = source.description->channels;
  const auto found = std::ranges::find(channels, name, &drivers::ChannelDescription::name);
  return found == channels.end() ? nullptr : &*found;
}

std::vector<std::string> names_of(const SourceView& source) {
  std::vector<std::string> names;
  for (const drivers::ChannelDescription& channel : source.description->channels) {
    names.push_back(channel.name);
  }
  return names;
}

std::string those_there(const SourceView& source, const std::string& wanted) {
  const auto names = names_of(source);
  const std::string nearest = nearest_name(wanted, names);
  return nearest.empty() ? fmt::format("it has: {}", fmt::join(names, ", "))
                         : fmt::format("did you mean '{}'?", nearest);
}

bool states_quantity(const drivers::ChannelDescription& channel) {
  return (!channel.unit.empty() && channel.unit != R"(\one)") ||
         quantity_of_word(channel.quantity) != Quantity::unknown;
}

std::string no_unit_sentence(const Role& role, const std::string& channel) {
  const std::string& name = role.key.back();
  if (name == "reference" || name == "dut") {
    return fmt::format(
        "gives no unit for channel '{0}': results will be in \"1\"; write units = {{ "
        "{0} = \"m/s^2\" }}",
        channel);
  }
  return fmt::format("gives no unit for channel '{0}': nothing shows whether {1} names the right "
                     "channel; write units = {{ {0} = \"{2}\" }}",
                     channel, name, name == "temperature" ? "degC" : "V");
}

// Of an interferometer, nothing of another source.
const drivers::interferometer::InterferometerSettings*
interferometer_of(const BenchView& view, const std::string& source) {
  const SourceSettings* settings = view.bench.source(source);
  return settings != nullptr && settings->interferometer ? &*settings->interferometer : nullptr;
}

bool is_raw_signal(const BenchView& view, const std::string& source, const std::string& channel) {
  const auto* interferometer = interferometer_of(view, source);
  return interferometer != nullptr &&
         (channel == interferometer->u1 || channel == interferometer->u2);
}

void check_roles(const BenchView& view, Findings& findings) {
  for (const Role& role : roles_of(view.bench.method)) {
    if (is_raw_signal(view, role.channel.source, role.channel.channel)) {
      findings.push_back(view.at(
          Severity::error, role.key,
          fmt::format("names '{}', a raw signal of the interferometer, which is not published; its "
                      "displacement is '{}/{}'",
                      role.channel.text(), role.channel.source,
                      interferometer_of(view, role.channel.source)->channel),
          role.entry));
      continue;
    }
    const SourceView* source = view.source(role.channel.source);
    if (source == nullptr || !source->description) {
      continue;
    }
    const auto* channel = find_channel(*source, role.channel.channel);
    if (channel == nullptr) {
      findings.push_back(view.at(Severity::error, role.key,
                                 fmt::format("names channel '{}', which source '{}' does not have; "
                                             "{}",
                                             role.channel.channel, role.channel.source,
                                             those_there(*source, role.channel.channel)),
                                 role.entry));
      continue;
    }
    if (!states_quantity(*channel)) {
      findings.push_back(view.at(Severity::warning, {"sources", source->name},
                                 no_unit_sentence(role, channel->name)));
    }
  }
}

// By the source; of an instrument, which is not asked, by the units that the bench file gives.
std::optional<drivers::ChannelDescription> described(const BenchView& view,
                                                     const ChannelName& name) {
  const SourceView* source = view.source(name.source);
  if (source != nullptr && source->description) {
    const auto* channel = find_channel(*source, name.channel);
    return channel != nullptr ? std::optional(*channel) : std::nullopt;
  }
  const SourceSettings* settings = view.bench.source(name.source);
  if (settings == nullptr) {
    return std::nullopt;
  }
  drivers::ChannelDescription channel;
  channel.name = name.channel;
  if (const auto* interferometer = interferometer_of(view, name.source);
      interferometer != nullptr && name.channel == interferometer->channel) {
    channel.unit = R"(\metre)";
  } else if (const auto unit = settings->units.find(name.channel); unit != settings->units.end()) {
    channel.unit = unit->second;
  } else if (const auto converted = settings->identity.units.find(name.channel);
             converted != settings->identity.units.end()) {
    channel.unit = converted->second.d_si;
  }
  return channel.unit.empty() ? std::nullopt : std::optional(channel);
}

void check_quantities(const BenchView& view, Findings& findings) {
  const MethodSettings& method = view.bench.method;
  const RoleNames names{method.kind,     method.reference, method.sync_acs,
                        method.sync_dau, method.dut,       method.temperature};
  const auto look_up = [&](const ChannelName& name) { return described(view, name); };
  for (RoleQuantityProblem& problem : find_quantity_problems(names, look_up)) {
    const auto entry = problem.role == "dut" ? std::optional(problem.entry) : std::nullopt;
    findings.push_back(
        view.at(Severity::error, {"method", problem.role}, std::move(problem.sentence), entry));
  }
}

// What is no quantity of a level at all is an error, of check_quantities().
void check_reference_unit(const BenchView& view, Findings& findings) {
  const auto channel = described(view, view.bench.method.reference);
  const auto* interferometer = interferometer_of(view, view.bench.method.reference.source);
  const bool is_of_interferometer =
      interferometer != nullptr && interferometer->channel == view.bench.method.reference.channel;
  const auto is_error = [](const Finding& finding) {
    return finding.severity == Severity::error && finding.subject == "method.reference";
  };
  if (channel && !channel->unit.empty() && channel->unit != R"(\one)" &&
      !is_acceleration(channel->unit) && !is_of_interferometer &&
      std::ranges::none_of(findings, is_error)) {
    findings.push_back(view.at(
        Severity::warning, {"method", "reference"},
        fmt::format("is in {}, but excitation.level is planned in m/s^2: the level that was "
                    "reached cannot be held against the plan",
                    short_form(channel->unit))));
  }
}

// Entries of `channels` and `units` that name nothing; an instrument is not asked, so its own
// names are not known.
void check_names(const BenchView& view, const SourceSettings& settings, Findings& findings) {
  std::set<std::string> renamed;
  for (const auto& [device, ours] : settings.channels) {
    if (!renamed.insert(ours).second) {
      findings.push_back(view.at(Severity::error, {"sources", settings.name, "channels"},
                                 fmt::format("gives two channels the name '{}'", ours)));
    }
  }
  const SourceView* source = view.source(settings.name);
  if (source == nullptr || !source->description) {
    return;
  }
  for (const auto& [device, ours] : settings.channels) {
    if (find_channel(*source, ours) == nullptr && !is_raw_signal(view, settings.name, ours)) {
      findings.push_back(view.at(Severity::warning, {"sources", settings.name, "channels"},
                                 fmt::format("renames '{}', which the source does not have; {}",
                                             device, those_there(*source, device))));
    }
  }
  std::set<std::string> with_unit;
  for (const auto& [channel, unit] : settings.units) {
    with_unit.insert(channel);
  }
  for (const auto& [channel, unit] : settings.identity.units) {
    with_unit.insert(channel);
  }
  for (const std::string& channel : with_unit) {
    if (find_channel(*source, channel) == nullptr && !is_raw_signal(view, settings.name, channel)) {
      findings.push_back(
          view.at(Severity::warning, {"sources", settings.name, "units"},
                  fmt::format("names channel '{}', which the source does not have; {}", channel,
                              those_there(*source, channel))));
    }
  }
}

// The stamps of a socket's stream are what the instrument says they are.
void check_time_base(const BenchView& view, Findings& findings) {
  const MethodSettings& method = view.bench.method;
  if (method.kind != EvaluationMethod::absolute_time) {
    return;
  }
  std::set<std::string> names{method.reference.source};
  for (const ChannelName& channel : method.dut) {
    names.insert(channel.source);
  }
  for (const std::string& name : names) {
    const SourceSettings* source = view.bench.source(name);
    if (source != nullptr && !source->is<SocketSourceSettings>() &&
        source->time_base == drivers::TimeBase::local) {
      findings.push_back(view.at(
          Severity::error, {"sources", name, "time_base"},
          "is local, but method.kind = \"absolute-time\" compares stamps of UTC: where they are "
          "that, write time_base = \"utc\", else use a sync signal"));
    }
  }
}

} // namespace

Findings check_channels(const BenchView& view) {
  Findings findings;
  check_roles(view, findings);
  check_quantities(view, findings);
  check_reference_unit(view, findings);
  check_time_base(view, findings);
  for (const SourceSettings& source : view.bench.sources) {
    check_names(view, source, findings);
  }
  return findings;
}

} // namespace dyncal::inline checks::bench_check
