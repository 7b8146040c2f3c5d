#include "services/security/strangers.hpp"

#include <array>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "services/security/identity_folder.hpp"
#include "services/security/pem_file.hpp"
#include "services/security/revoked_participants.hpp"

namespace dyncal::inline security {
namespace {

constexpr std::size_t max_named = 4;

bool is_secured(const std::string& id) {
  return !id.empty() && id.front() >= '8'; // in hexadecimal; letters come behind digits
}

std::string reason_of(const Stranger& stranger, const std::set<std::string>& revoked) {
  if (!is_secured(stranger.id)) {
    return "without --security";
  }
  if (revoked.contains(stranger.id.substr(0, 2 * std::tuple_size_v<GuidStart>))) {
    return "revoked";
  }
  return stranger.reason.empty() ? "of another authority or governance, or expired"
                                 : stranger.reason;
}

} // namespace

std::string strangers_sentence(const std::vector<Stranger>& strangers,
                               const std::filesystem::path& revoked) {
  if (strangers.empty()) {
    return "";
  }
  std::set<std::string> starts;
  for (const GuidStart& start : revoked_guid_starts(revoked)) {
    starts.insert(bus::hexadecimal(start.data(), start.size()));
  }
  std::vector<std::string> texts;
  for (const Stranger& one : strangers) {
    if (texts.size() < max_named) {
      texts.push_back(
          fmt::format("{} ({})", one.name.empty() ? one.id : one.name, reason_of(one, starts)));
    }
  }
  if (strangers.size() > max_named) {
    texts.push_back(fmt::format("and {} more", strangers.size() - max_named));
  }
  return fmt::format("{} {} here that this program may not talk to: {}", strangers.size(),
                     strangers.size() == 1 ? "program is" : "programs are", fmt::join(texts, ", "));
}

std::string authority_of(const std::filesystem::path& folder) {
  const auto vendor = bus::vendors_in_this_build().front(); // whose does not matter here
  const auto authorities = read_certificates(security_files(folder, vendor).authority);
  if (!authorities) {
    return "";
  }
  std::array<char, 512> subject{};
  X509_NAME_oneline(X509_get_subject_name(authorities->front().get()), subject.data(),
                    static_cast<int>(subject.size()));
  return subject.data();
}

std::vector<Stranger> without_endpoints(const bus::Discovery& discovery) {
  std::set<std::string> known;
  for (const bus::DiscoveredEndpoint& endpoint : discovery.endpoints) {
    known.insert(endpoint.participant);
  }
  std::vector<Stranger> strangers;
  for (const bus::DiscoveredParticipant& one : discovery.participants) {
    if (!known.contains(one.id)) {
      strangers.push_back({one.id, one.name});
    }
  }
  return strangers;
}

void StrangerWatch::look(const bus::Discovery& discovery, Instant now) {
  for (const bus::DiscoveredEndpoint& endpoint : discovery.endpoints) {
    seen_.erase(endpoint.participant);
  }
  std::erase_if(seen_, [&](const auto& one) { return now - one.second.last > forgotten_after; });
  for (const Stranger& one : without_endpoints(discovery)) {
    if (const auto known = seen_.find(one.id); known != seen_.end()) {
      known->second.last = now;
    } else if (seen_.size() < max_strangers) {
      seen_[one.id] = {one.name, now, now};
    }
  }
}

std::vector<Stranger> StrangerWatch::strangers(std::chrono::nanoseconds for_at_least) const {
  std::vector<Stranger> strangers;
  for (const auto& [id, one] : seen_) {
    if (one.last - one.first >= for_at_least) {
      strangers.push_back({id, one.name});
    }
  }
  return strangers;
}

} // namespace dyncal::inline security
