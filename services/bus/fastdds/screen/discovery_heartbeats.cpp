#include "services/bus/fastdds/screen/discovery_heartbeats.hpp"

#include <algorithm>
#include <cstring>

#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {
namespace {

using namespace rtps_format; // the submessages of DDSI-RTPS 2.2, 8.3.7

// ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER and its twin for subscriptions (DDSI-RTPS 9.3.2).
constexpr std::uint32_t of_publications = 0x000003c2;
constexpr std::uint32_t of_subscriptions = 0x000004c2;

constexpr std::size_t last_at = entities_bytes + sequence_bytes; // in a HEARTBEAT
constexpr std::size_t count_at = last_at + sequence_bytes;
constexpr std::size_t heartbeat_body_bytes = count_at + 4;
constexpr std::size_t writer_at_in_data = 2 * entity_bytes;
constexpr std::size_t sequence_at_in_data = writer_at_in_data + entity_bytes;

// Of discovery; 0: of something else. Entities stand in network order whatever the flags.
std::uint32_t discovery_writer(Bytes body, std::size_t at) {
  const auto writer = number_at<std::uint32_t>(body, at, 0);
  return writer == of_publications || writer == of_subscriptions ? writer : 0;
}

std::uint32_t writer_of(const Submessage& one) {
  if ((one.flags & little_endian_flag) == 0) {
    return 0; // not sent by this machine
  }
  if (one.id == heartbeat && one.body.size() >= heartbeat_body_bytes &&
      sequence_at(one.body, last_at, one.flags)) {
    return discovery_writer(one.body, entity_bytes);
  }
  return one.id == data && one.body.size() >= sequence_at_in_data + sequence_bytes &&
                 sequence_at(one.body, sequence_at_in_data, one.flags)
             ? discovery_writer(one.body, writer_at_in_data)
             : 0;
}

Prefix prefix_in(Bytes info_destination) {
  Prefix prefix{};
  std::copy_n(info_destination.begin() + submessage_header_bytes, prefix_bytes, prefix.begin());
  return prefix;
}

void put_sequence(std::int64_t sequence, std::span<unsigned char> to) {
  const auto high = static_cast<std::uint32_t>(static_cast<std::uint64_t>(sequence) >> 32U);
  const auto low = static_cast<std::uint32_t>(sequence);
  std::memcpy(to.data(), &high, sizeof high);
  std::memcpy(to.data() + sizeof high, &low, sizeof low);
}

void put_count(std::uint32_t count, std::span<unsigned char> to) {
  std::memcpy(to.data(), &count, sizeof count);
}

} // namespace

std::optional<DiscoveryHeartbeats::Datagram>
DiscoveryHeartbeats::counted(std::span<const unsigned char> datagram) {
  std::optional<Datagram> changed;
  visit_submessages(datagram, [&](const Submessage& one) {
    if (const Writer writer = writer_of(one); writer != 0) {
      if (!changed) {
        changed.emplace(datagram.begin(), datagram.end());
      }
      if (one.id == heartbeat) {
        const auto body = static_cast<std::size_t>(one.body.data() - datagram.data());
        put_count(++counts_[writer], std::span(*changed).subspan(body + count_at));
      }
    }
    return true;
  });
  return changed;
}

void DiscoveryHeartbeats::sent(std::span<const unsigned char> datagram, Destination destination,
                               Instant now) {
  Bytes said_whom; // the submessage, empty where there is none
  visit_submessages(datagram, [&](const Submessage& one) {
    const Bytes whole(one.body.data() - submessage_header_bytes,
                      one.body.size() + submessage_header_bytes);
    if (one.id == info_destination && one.body.size() >= prefix_bytes) {
      said_whom = whole;
    }
    const Writer writer = writer_of(one);
    const std::pair key(destination, writer);
    const bool is_known = newest_.contains(key);
    if (writer == 0 || (!is_known && newest_.size() >= max_destinations)) {
      return true;
    }
    if (one.id == data) {
      if (is_known) {
        keep(newest_[key], *sequence_at(one.body, sequence_at_in_data, one.flags), now);
      }
      return true;
    }
    Newest& newest = newest_[key];
    if (!is_known || !said_whom.empty()) { // one to all says less
      const auto whom = said_whom.empty() ? std::nullopt : std::optional(prefix_in(said_whom));
      newest.last = newest.whom == whom ? newest.last : none;
      newest.whom = whom;
      newest.heartbeat.assign(datagram.begin(), datagram.begin() + header_bytes);
      newest.heartbeat.insert(newest.heartbeat.end(), said_whom.begin(), said_whom.end());
      newest.heartbeat.insert(newest.heartbeat.end(), whole.begin(), whole.end());
      newest.body = newest.heartbeat.size() - one.body.size();
    }
    keep(newest, *sequence_at(one.body, last_at, one.flags), now);
    return true;
  });
}

void DiscoveryHeartbeats::keep(Newest& newest, std::int64_t last, Instant now) {
  if (last > newest.last) {
    newest.last = last;
    newest.repeated = 0;
    newest.next = now + first_repeat;
    earliest_ = std::min(earliest_, newest.next);
  }
  put_sequence(newest.last, std::span(newest.heartbeat).subspan(newest.body + last_at));
}

void DiscoveryHeartbeats::received(std::span<const unsigned char> datagram) {
  if (datagram.size() < header_bytes) {
    return;
  }
  Prefix sender{};
  std::copy_n(datagram.begin() + header_bytes - prefix_bytes, prefix_bytes, sender.begin());
  visit_submessages(datagram, [&](const Submessage& one) {
    if (one.id == acknack && one.body.size() >= entities_bytes + sequence_bytes) {
      const Writer writer = discovery_writer(one.body, entity_bytes);
      const auto base = sequence_at(one.body, entities_bytes, one.flags);
      if (writer != 0 && base) {
        acknowledged(sender, writer, *base);
      }
    }
    return true;
  });
}

void DiscoveryHeartbeats::acknowledged(const Prefix& whom, Writer writer, std::int64_t base) {
  for (auto& [key, newest] : newest_) {
    if (key.second == writer && newest.whom == whom && base > newest.last) {
      newest.repeated = max_repeats;
    }
  }
}

std::vector<DiscoveryHeartbeats::Due> DiscoveryHeartbeats::due(Instant now) {
  std::vector<Due> all;
  if (now < earliest_) {
    return all;
  }
  earliest_ = Instant::max();
  for (auto& [key, newest] : newest_) {
    if (newest.repeated == max_repeats) {
      continue;
    }
    if (now >= newest.next) {
      put_count(++counts_[key.second], std::span(newest.heartbeat).subspan(newest.body + count_at));
      all.push_back({key.first, newest.heartbeat});
      if (++newest.repeated == max_repeats) {
        continue;
      }
      newest.next = now + next_repeat;
    }
    earliest_ = std::min(earliest_, newest.next);
  }
  return all;
}

} // namespace dyncal::bus
