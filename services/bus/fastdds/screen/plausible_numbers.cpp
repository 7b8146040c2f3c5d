#include "services/bus/fastdds/screen/plausible_numbers.hpp"

#include <algorithm>
#include <string_view>

namespace dyncal::bus {

using namespace rtps_format;
using Kind = GrowingNumber::Kind;

std::size_t PlausibleNumbers::KeyHash::operator()(const Key& key) const {
  return std::hash<std::string_view>()(
      {reinterpret_cast<const char*>(key.data()), key.size()}); // NOLINT: bytes as characters
}

PlausibleNumbers::Key PlausibleNumbers::of_writer(const Way& way, Bytes writer, Numbered numbered) {
  Key key{};
  const auto behind = std::ranges::copy(way.from, key.begin()).out;
  std::ranges::copy(writer.first(entity_bytes), behind);
  key.back() = static_cast<unsigned char>(numbered);
  return key;
}

// Readers of one participant count for each writer, and writers of two participants can have the
// same id.
PlausibleNumbers::Key PlausibleNumbers::of_reader(const Way& way, Bytes entities,
                                                  Numbered numbered) {
  Key key{};
  auto behind = std::ranges::copy(way.from, key.begin()).out;
  behind = std::ranges::copy(entities.first(entities_bytes), behind).out;
  std::ranges::copy(way.to, behind);
  key.back() = static_cast<unsigned char>(numbered);
  return key;
}

bool PlausibleNumbers::accepts(const Way& way, unsigned char id, unsigned char flags, Bytes body) {
  const std::lock_guard lock(mutex_);
  switch (id) {
  case data:
  case data_frag:
    return accepts_sample(way, flags, body);
  case gap:
    return accepts_gap(way, flags, body);
  case heartbeat:
    return accepts_heartbeat(way, flags, body);
  case heartbeat_frag:
    return accepts_heartbeat_frag(way, flags, body);
  case acknack:
    return accepts_acknack(way, flags, body);
  case nack_frag:
    return accepts_nack_frag(way, flags, body);
  default:
    return true;
  }
}

void PlausibleNumbers::forget(const std::set<Prefix>& participants) {
  const auto is_of_one = [&](const auto& number) {
    const Key& key = number.first;
    Prefix from{};
    Prefix to{};
    std::copy_n(key.begin(), prefix_bytes, from.begin());
    std::copy_n(key.begin() + prefix_bytes + entities_bytes, prefix_bytes, to.begin());
    return participants.contains(from) || participants.contains(to);
  };
  const std::lock_guard lock(mutex_);
  std::erase_if(newcomers_, is_of_one);
  std::erase_if(known_, is_of_one);
}

std::size_t PlausibleNumbers::known() const {
  const std::lock_guard lock(mutex_);
  return known_.size() + newcomers_.size();
}

GrowingNumber::Kind PlausibleNumbers::judge(const Key& key, std::int64_t number,
                                            std::int64_t max_step) {
  if (const auto known = known_.find(key); known != known_.end()) {
    return known->second.judge(number, max_step);
  }
  if (newcomers_.size() >= max_newcomers) {
    newcomers_.clear();
  }
  const auto newcomer = newcomers_.try_emplace(key).first;
  const Kind kind = newcomer->second.judge(number, max_step);
  if (newcomer->second.agreed()) {
    if (known_.size() >= max_known) {
      known_.clear();
    }
    known_.insert(newcomers_.extract(newcomer));
  }
  return kind;
}

bool PlausibleNumbers::is_plausible(const Key& key, std::int64_t number,
                                    std::int64_t max_step) const {
  const auto known = known_.find(key);
  return known == known_.end() || known->second.is_plausible(number, max_step);
}

bool PlausibleNumbers::accepts_sample(const Way& way, unsigned char flags, Bytes body) {
  constexpr std::size_t writer_at = 8;
  if (body.size() < data_bytes_before_qos) {
    return true;
  }
  const auto number = sequence_at(body, writer_at + entity_bytes, flags);
  return number && judge(of_writer(way, body.subspan(writer_at), Numbered::samples), *number,
                         max_samples_ahead) != Kind::implausible;
}

bool PlausibleNumbers::accepts_gap(const Way& way, unsigned char flags, Bytes body) {
  constexpr std::size_t base_at = entities_bytes + sequence_bytes;
  constexpr std::size_t bits_at = base_at + sequence_bytes;
  const auto words = bitmap_words(body, bits_at, flags);
  if (!words) {
    return true;
  }
  const auto first = sequence_at(body, entities_bytes, flags);
  const auto base = sequence_at(body, base_at, flags);
  if (!first || !base) {
    return false;
  }
  const std::int64_t newest = *base - 1 + number_at<std::uint32_t>(body, bits_at, flags);
  const Key samples = of_writer(way, body.subspan(entity_bytes), Numbered::samples);
  return is_plausible(samples, newest, max_samples_ahead) &&
         judge(samples, newest, max_samples_ahead) != Kind::implausible;
}

bool PlausibleNumbers::accepts_heartbeat(const Way& way, unsigned char flags, Bytes body) {
  constexpr std::size_t last_at = entities_bytes + sequence_bytes;
  constexpr std::size_t count_at = last_at + sequence_bytes;
  if (body.size() < count_at + 4) {
    return true;
  }
  const auto first = sequence_at(body, entities_bytes, flags);
  const auto last = sequence_at(body, last_at, flags);
  if (!first || !last) {
    return false;
  }
  const Bytes writer = body.subspan(entity_bytes);
  const Kind count = judge(of_writer(way, writer, Numbered::heartbeats),
                           number_at<std::uint32_t>(body, count_at, flags), max_counts_ahead);
  if (*first > *last + 1 || count == Kind::implausible) {
    return false;
  }
  const Key samples = of_writer(way, writer, Numbered::samples);
  // An old one tells nothing of the numbers; libraries pass over it, but not at once.
  return count == Kind::newer ? judge(samples, *last, max_announced_ahead) != Kind::implausible
                              : is_plausible(samples, *last, max_announced_ahead);
}

bool PlausibleNumbers::accepts_heartbeat_frag(const Way& way, unsigned char flags, Bytes body) {
  constexpr std::size_t count_at = entities_bytes + sequence_bytes + 4;
  return body.size() < count_at + 4 ||
         (sequence_at(body, entities_bytes, flags) &&
          judge(of_writer(way, body.subspan(entity_bytes), Numbered::heartbeat_frags),
                number_at<std::uint32_t>(body, count_at, flags),
                max_counts_ahead) != Kind::implausible);
}

bool PlausibleNumbers::accepts_acknack(const Way& way, unsigned char flags, Bytes body) {
  constexpr std::size_t bits_at = entities_bytes + sequence_bytes;
  const auto words = bitmap_words(body, bits_at, flags);
  const std::size_t count_at = bits_at + 4 + 4 * words.value_or(0);
  if (!words || body.size() < count_at + 4) {
    return true;
  }
  const auto base = sequence_at(body, entities_bytes, flags);
  if (!base) {
    return false;
  }
  const Kind count = judge(of_reader(way, body, Numbered::acks),
                           number_at<std::uint32_t>(body, count_at, flags), max_counts_ahead);
  const Key bases = of_reader(way, body, Numbered::base);
  return count == Kind::newer   ? judge(bases, *base, max_acknowledged_ahead) != Kind::implausible
         : count == Kind::known ? is_plausible(bases, *base, max_acknowledged_ahead)
                                : false;
}

bool PlausibleNumbers::accepts_nack_frag(const Way& way, unsigned char flags, Bytes body) {
  constexpr std::size_t bits_at = entities_bytes + sequence_bytes + 4;
  const auto words = bitmap_words(body, bits_at, flags);
  const std::size_t count_at = bits_at + 4 + 4 * words.value_or(0);
  return !words || body.size() < count_at + 4 ||
         (sequence_at(body, entities_bytes, flags) &&
          judge(of_reader(way, body, Numbered::nacks),
                number_at<std::uint32_t>(body, count_at, flags),
                max_counts_ahead) != Kind::implausible);
}

} // namespace dyncal::bus
