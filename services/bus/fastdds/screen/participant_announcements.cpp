#include "services/bus/fastdds/screen/participant_announcements.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "services/bus/fastdds/screen/security_tokens.hpp"

namespace dyncal::bus {

using namespace rtps_format;

namespace {

constexpr std::array<unsigned char, entity_bytes> participant_entity{0x00, 0x00, 0x01, 0xc1};
constexpr std::array<unsigned char, entity_bytes> participant_writer{0x00, 0x01, 0x00, 0xc2};
constexpr std::array<unsigned char, entity_bytes> publications_writer{0x00, 0x00, 0x03, 0xc2};
constexpr std::array<unsigned char, entity_bytes> subscriptions_writer{0x00, 0x00, 0x04, 0xc2};

constexpr std::uint16_t pid_participant_guid = 0x0050;
constexpr std::uint16_t pid_endpoint_guid = 0x005a;
constexpr std::uint16_t pid_data_representation = 0x0073;
// Lease duration, protocol version, vendor, locators and built-in endpoints of a participant.
constexpr std::array<std::uint16_t, 9> lasting = {
    0x0002, 0x0015, 0x0016, 0x0031, 0x0032, 0x0033, 0x0048, 0x0058, pid_participant_guid};

struct Announced {
  std::optional<Bytes> guid;
  std::string lasting_fields;
};

// What Fast DDS reads for as long as it says that it is, and asks for memory for: gigabytes of data
// representations that are not there.
bool is_whole(std::uint16_t parameter, Bytes value, unsigned char flags) {
  if (parameter == pid_data_representation) {
    constexpr std::size_t count_bytes = sizeof(std::uint32_t);
    return value.size() >= count_bytes && number_at<std::uint32_t>(value, 0, flags) <=
                                              (value.size() - count_bytes) / sizeof(std::uint16_t);
  }
  return !is_security_token(parameter) || token_is_whole(value, flags);
}

// Nothing where it is no list of parameters, or one in it is not whole.
std::optional<Announced> announced_in(Bytes payload, std::uint16_t guid_parameter) {
  constexpr std::size_t encapsulation_bytes = 4;
  if (payload.size() < encapsulation_bytes || payload[0] != 0 ||
      (payload[1] != 2 && payload[1] != 3)) {
    return std::nullopt;
  }
  const unsigned char flags = payload[1] == 3 ? little_endian_flag : 0;
  Announced found;
  for (std::size_t at = encapsulation_bytes; at + 4 <= payload.size();) {
    const auto id = number_at<std::uint16_t>(payload, at, flags);
    const std::size_t length = number_at<std::uint16_t>(payload, at + 2, flags);
    if (id == pid_sentinel) {
      return found;
    }
    if (at + 4 + length > payload.size()) {
      return std::nullopt;
    }
    const Bytes parameter = payload.subspan(at, 4 + length);
    if (!is_whole(id, parameter.subspan(4), flags)) {
      return std::nullopt;
    }
    if (id == guid_parameter) {
      found.guid = parameter.subspan(4);
    }
    if (std::ranges::find(lasting, id) != lasting.end()) {
      found.lasting_fields.append(parameter.begin(), parameter.end());
    }
    at += 4 + ((length + 3U) & ~std::size_t{3});
  }
  return std::nullopt;
}

bool is_of(const std::optional<Bytes>& guid, const Prefix& prefix, bool is_participant) {
  if (!guid) {
    return !is_participant;
  }
  return guid->size() == prefix_bytes + entity_bytes &&
         std::ranges::equal(guid->first(prefix_bytes), prefix) &&
         (!is_participant || std::ranges::equal(guid->last(entity_bytes), participant_entity));
}

} // namespace

bool announces_participant(Bytes datagram) {
  constexpr std::size_t writer_at = 8;
  bool found = false;
  visit_submessages(datagram, [&](const Submessage& one) {
    found = one.id == data && one.body.size() >= writer_at + entity_bytes &&
            std::ranges::equal(one.body.subspan(writer_at, entity_bytes), participant_writer);
    return !found;
  });
  return found;
}

bool ParticipantAnnouncements::accepts(const Prefix& from, unsigned char flags, Bytes body,
                                       Instant now) {
  constexpr std::size_t writer_at = 8;
  const auto begin = qos_begin(body, data_bytes_before_qos, flags);
  const auto qos = begin ? inline_qos(body, *begin, flags) : std::nullopt;
  if (!qos) {
    return true; // not whole
  }
  const Bytes writer = body.subspan(writer_at, entity_bytes);
  const bool is_participant = std::ranges::equal(writer, participant_writer);
  const bool is_endpoint = std::ranges::equal(writer, publications_writer) ||
                           std::ranges::equal(writer, subscriptions_writer);
  if (!is_participant && !is_endpoint) {
    return true;
  }
  if (qos->ends_instance) {
    return is_endpoint || accepts_goodbye(from);
  }
  if ((flags & data_flag) == 0) {
    return false; // neither one thing nor the other
  }
  auto announced = announced_in(body.subspan(qos->end),
                                is_participant ? pid_participant_guid : pid_endpoint_guid);
  if (!announced || !is_of(announced->guid, from, is_participant)) {
    return false;
  }
  if (is_participant) {
    return accepts_announcement(from, announced->lasting_fields, now);
  }
  const auto number = sequence_at(body, writer_at + entity_bytes, flags);
  return number && (!announced->guid || accepts_endpoint(*announced->guid, *number));
}

template <class Value>
bool ParticipantAnnouncements::Lasting<Value>::accepts(const Value& announced) {
  if (announced == value) {
    changed_in_a_row = 0;
    return true;
  }
  changed_in_a_row = announced == changed ? changed_in_a_row + 1 : 1;
  changed = announced;
  if (changed_in_a_row < sure_after) {
    return false;
  }
  value = announced;
  changed_in_a_row = 0;
  return true;
}

bool ParticipantAnnouncements::accepts_goodbye(const Prefix& from) {
  const std::lock_guard lock(mutex_);
  const auto known = known_.find(from);
  return known == known_.end() || !std::exchange(known->second.has_left, true);
}

bool ParticipantAnnouncements::accepts_announcement(const Prefix& from,
                                                    const std::string& announced, Instant now) {
  const std::lock_guard lock(mutex_);
  if (known_.size() >= max_participants && !known_.contains(from)) {
    known_.clear();
  }
  Known& known = known_.try_emplace(from, Known{.fields = {.value = announced}}).first->second;
  known.heard = now;
  return known.fields.accepts(announced);
}

std::set<Prefix> ParticipantAnnouncements::forget_the_gone(Instant now) {
  std::set<Prefix> gone;
  const std::lock_guard lock(mutex_);
  std::erase_if(known_, [&](const auto& one) {
    return now - one.second.heard > silence_limit && gone.insert(one.first).second;
  });
  std::erase_if(endpoints_, [&](const auto& one) {
    Prefix prefix{};
    std::copy_n(one.first.begin(), prefix.size(), prefix.begin());
    return gone.contains(prefix);
  });
  return gone;
}

bool ParticipantAnnouncements::accepts_endpoint(Bytes guid, std::int64_t number) {
  EndpointGuid endpoint{};
  std::ranges::copy(guid, endpoint.begin());
  const std::lock_guard lock(mutex_);
  if (endpoints_.size() >= max_endpoints && !endpoints_.contains(endpoint)) {
    endpoints_.clear();
  }
  return endpoints_.try_emplace(endpoint, Lasting<std::int64_t>{.value = number})
      .first->second.accepts(number);
}

} // namespace dyncal::bus
