#include <algorithm>
#include <cctype>
#include <map>

#include <fmt/core.h>

#include "drivers/link/address.hpp"
#include "services/checks/bench_check/checks.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

// Somebody who wants something for itself: a place in a bench file.
struct Claim {
  const BenchView* view = nullptr;
  KeyPath key;
  std::string who; // "source 'acs' of bench 'acc-1'"
};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

// An instrument's address in one spelling.
std::string one_spelling(const std::string& address) {
  std::string one = lower(address);
  const auto parsed = drivers::parse_address(one);
  return parsed && parsed->host == "localhost" ? drivers::Address{"127.0.0.1", parsed->port}.text()
                                               : one;
}

Claim claim_of(const BenchView& view, const SourceSettings& source, const char* key) {
  return {&view,
          {"sources", source.name, key},
          fmt::format("source '{}' of bench '{}'", source.name, view.bench.bench)};
}

// What each wants, by the thing that is wanted: the second and later ones are findings.
class Claims {
public:
  explicit Claims(std::string what) : what_(std::move(what)) {}

  void add(const std::string& wanted, Claim claim, Findings& findings) {
    const auto [first, alone] = first_.try_emplace(wanted, claim);
    if (!alone) {
      findings.push_back(claim.view->at(
          Severity::error, claim.key,
          fmt::format("is {}, which {} has already: {}", wanted, first->second.who, what_)));
    }
  }

private:
  std::string what_;
  std::map<std::string, Claim> first_;
};

void check_address(const BenchView& view, const KeyPath& key, const std::string& address,
                   Findings& findings) {
  if (address.empty() || address.starts_with("vxi11:")) {
    return;
  }
  if (const auto parsed = drivers::parse_address(address); !parsed || parsed->port == 0) {
    findings.push_back(view.at(Severity::error, key,
                               fmt::format("is \"{}\", which is not an address: write HOST:PORT, "
                                           "for example 127.0.0.1:5026",
                                           address)));
  }
}

// Address of the instrument that a source connects to; empty: none.
std::string address_of(const SourceSettings& source) {
  if (const auto* socket = source.as<SocketSourceSettings>()) {
    return socket->address;
  }
  if (const auto* acs = source.as<AcsSourceSettings>()) {
    const auto address = acs->texts.find("address");
    return address == acs->texts.end() ? "" : address->second;
  }
  if (const auto* scope = source.as<OscilloscopeSourceSettings>()) {
    return scope->address;
  }
  const auto* series = source.as<SeriesSourceSettings>();
  return series != nullptr ? series->address : "";
}

void check_addresses(std::span<const BenchView> views, Findings& findings) {
  Claims instruments("an instrument serves one program; give this one its own address");
  for (const BenchView& view : views) {
    const std::string& generator = view.bench.generator.address;
    if (is_instrument(view.bench.generator.driver) && !generator.empty()) {
      const KeyPath key{"generator", "address"};
      check_address(view, key, generator, findings);
      instruments.add(one_spelling(generator),
                      {&view, key, fmt::format("the generator of bench '{}'", view.bench.bench)},
                      findings);
    }
    for (const SourceSettings& source : view.bench.sources) {
      if (const auto* smartup = source.as<SmartupSourceSettings>()) {
        check_address(view, {"sources", source.name, "listen"}, smartup->listen, findings);
      }
      const std::string address = address_of(source);
      check_address(view, {"sources", source.name, "address"}, address, findings);
      // An oscilloscope may have the generator built in.
      if (!address.empty() && !(source.is<OscilloscopeSourceSettings>() && address == generator)) {
        instruments.add(one_spelling(address), claim_of(view, source, "address"), findings);
      }
    }
  }
}

// One of them is all addresses of the machine, and the other is among them.
bool overlap(const std::string& one, const std::string& other) {
  const auto a = drivers::parse_address(one);
  const auto b = drivers::parse_address(other);
  const auto is_all = [](const std::string& host) { return host == "0.0.0.0" || host == "::"; };
  return a && b && a->port == b->port && a->host != b->host && (is_all(a->host) || is_all(b->host));
}

void check_overlaps(std::span<const BenchView> views, Findings& findings) {
  std::map<std::string, Claim> places; // by `listen`
  for (const BenchView& view : views) {
    for (const SourceSettings& source : view.bench.sources) {
      const auto* smartup = source.as<SmartupSourceSettings>();
      if (smartup == nullptr) {
        continue;
      }
      for (const auto& [place, claim] : places) {
        if (overlap(place, smartup->listen)) {
          findings.push_back(view.at(
              Severity::error, {"sources", source.name, "listen"},
              fmt::format("is {}, but {} listens at {}, which takes the same datagrams: write the "
                          "same address for both, or give one another port",
                          smartup->listen, claim.who, place)));
        }
      }
      places.try_emplace(smartup->listen, claim_of(view, source, "listen"));
    }
  }
}

// Sensors of several benches may come in at one port if one program serves them all: then
// dyncal-dau is given all their files.
void check_ports(std::span<const BenchView> views, Findings& findings) {
  Claims sensors("a sensor has one bench");
  std::map<std::string, const BenchView*> first;
  for (const BenchView& view : views) {
    for (const SourceSettings& source : view.bench.sources) {
      const auto* smartup = source.as<SmartupSourceSettings>();
      if (smartup == nullptr) {
        continue;
      }
      sensors.add(fmt::format("sensor {:#010x} at {}", smartup->sensor, smartup->listen),
                  claim_of(view, source, "sensor"), findings);
      if (smartup->sync_sensor == smartup->sensor) {
        findings.push_back(view.at(Severity::error, {"sources", source.name, "sync_sensor"},
                                   "is the same as sensor: leave it out where one id carries "
                                   "both"));
      }
      const auto [owner, alone] = first.try_emplace(smartup->listen, &view);
      if (!alone && owner->second != &view) {
        findings.push_back(
            view.at(Severity::warning, {"sources", source.name, "listen"},
                    fmt::format("is {}, as in bench '{}': on one machine give both files to one "
                                "dyncal-dau, or each bench its own port",
                                smartup->listen, owner->second->bench.bench)));
      }
    }
  }
}

std::string hexadecimal(std::uint32_t id) {
  return fmt::format("{:#x}", id);
}

void check_can(std::span<const BenchView> views, Findings& findings) {
  Claims messages("a message belongs to one source; name others in `messages`");
  std::map<std::string, std::pair<double, Claim>> rates; // by interface
  for (const BenchView& view : views) {
    for (const SourceSettings& source : view.bench.sources) {
      const auto* can = source.as<CanSourceSettings>();
      if (can == nullptr) {
        continue;
      }
      const std::string bus =
          can->log.empty() ? can->interface_name : can->log.string() + " " + can->interface_name;
      for (const CanMessage& message : view.source(source.name)->messages) {
        messages.add(
            fmt::format("message {} ({}) on {}", hexadecimal(message.id), message.name, bus),
            claim_of(view, source, can->messages.empty() ? "dbc" : "messages"), findings);
      }
      const auto [first, alone] = rates.try_emplace(bus, can->bit_rates.nominal_per_s,
                                                    claim_of(view, source, "bit_rate_per_s"));
      if (!alone && can->bit_rates.nominal_per_s > 0.0 && first->second.first > 0.0 &&
          can->bit_rates.nominal_per_s != first->second.first) {
        findings.push_back(
            view.at(Severity::error, {"sources", source.name, "bit_rate_per_s"},
                    fmt::format("is {:g}, but {} gives {} the rate {:g}: a bus has one rate",
                                can->bit_rates.nominal_per_s, first->second.second.who, bus,
                                first->second.first)));
      }
    }
  }
}

void check_names(std::span<const BenchView> views, Findings& findings) {
  Claims benches("every bench of a laboratory has its own name");
  for (const BenchView& view : views) {
    if (!view.bench.bench.empty()) {
      benches.add(view.bench.bench, {&view, {"bench"}, view.bench.path.string()}, findings);
    }
    std::map<std::string, std::string> names;
    for (const SourceSettings& source : view.bench.sources) {
      const auto [first, alone] = names.try_emplace(lower(source.name), source.name);
      if (!alone) {
        findings.push_back(view.at(Severity::warning, {"sources", source.name},
                                   fmt::format("differs from source '{}' in capital letters "
                                               "alone: give one of them another name",
                                               first->second)));
      }
    }
  }
}

} // namespace

Findings check_collisions(std::span<const BenchView> views) {
  Findings findings;
  check_addresses(views, findings);
  check_ports(views, findings);
  check_overlaps(views, findings);
  check_can(views, findings);
  check_names(views, findings);
  return findings;
}

} // namespace dyncal::inline checks::bench_check
