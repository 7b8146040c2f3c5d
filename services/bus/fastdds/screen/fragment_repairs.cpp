#include "services/bus/fastdds/screen/fragment_repairs.hpp"

#include <algorithm>
#include <functional>
#include <string_view>
#include <vector>

#include "services/bus/fastdds/screen/rtps_format.hpp"

namespace dyncal::bus {
namespace {

using namespace rtps_format; // the submessages of DDSI-RTPS 2.2, 8.3.7

constexpr std::size_t first_fragment_end = entity_bytes + entities_bytes + sequence_bytes + 4;

std::size_t hash_of(Bytes bytes) {
  return std::hash<std::string_view>{}(
      std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

// Apart from each other, whatever they are made of.
std::size_t both(std::size_t first, std::size_t second) {
  return first * 0x9e3779b97f4a7c15U + second;
}

// Fast DDS ends its datagrams with one of its own, about its statistics.
constexpr unsigned char first_of_vendors = 0x80;

bool carries_nothing(unsigned char id) {
  return id >= first_of_vendors || id == info_timestamp || id == info_destination ||
         id == info_source || id == pad;
}

} // namespace

bool FragmentRepairs::went_lately(std::span<const unsigned char> datagram, std::size_t destination,
                                  Instant now) {
  forget(now);
  constexpr std::size_t reader_at = entity_bytes; // behind flags and the place of the QoS
  std::vector<Fragment> fragments;
  std::size_t participant = 0;
  const bool only_fragments = visit_submessages(datagram, [&](const Submessage& one) {
    if (one.id == data_frag && one.body.size() >= first_fragment_end) {
      // The writer, the number of the sample and that of the fragment stand side by side.
      const std::size_t reader_end = reader_at + entity_bytes;
      const std::size_t to_all =
          both(destination, hash_of(one.body.subspan(reader_end, first_fragment_end - reader_end)));
      const Bytes reader = one.body.subspan(reader_at, entity_bytes);
      const bool for_all = participant == 0 && std::ranges::count(reader, 0) == entity_bytes;
      fragments.push_back(
          {for_all ? to_all : both(to_all, both(participant, hash_of(reader))), to_all});
      return true;
    }
    if (one.id == info_destination && one.body.size() >= prefix_bytes) {
      participant = hash_of(one.body.first(prefix_bytes));
    }
    return carries_nothing(one.id);
  });
  const bool all_went =
      only_fragments && !fragments.empty() &&
      std::ranges::all_of(fragments, [&](const Fragment& one) { return went_lately(one, now); });
  if (!all_went) {
    for (const Fragment& fragment : fragments) {
      note(fragment, now);
    }
  }
  return all_went;
}

bool FragmentRepairs::went_lately(const Fragment& fragment, Instant now) const {
  const auto to_reader = sent_.find(fragment.to_reader);
  const auto to_all = sent_.find(fragment.to_all);
  return (to_reader != sent_.end() && now - to_reader->second.at < to_reader->second.interval) ||
         (to_all != sent_.end() && now - to_all->second.at < min_interval);
}

void FragmentRepairs::note(const Fragment& fragment, Instant now) {
  const auto interval = sent_.contains(fragment.to_all) ? 2 * min_interval : min_interval;
  const auto [known, is_new] = sent_.try_emplace(fragment.to_reader, Sent{now, interval});
  if (!is_new) {
    known->second = {now, std::min(2 * known->second.interval, max_interval)};
  }
  in_order_.emplace_back(fragment.to_reader, now);
}

void FragmentRepairs::forget(Instant now) {
  while (!in_order_.empty() &&
         (now - in_order_.front().second >= max_interval || in_order_.size() > max_fragments)) {
    const auto& [fragment, at] = in_order_.front();
    const auto known = sent_.find(fragment);
    if (known != sent_.end() && known->second.at == at) {
      sent_.erase(known);
    }
    in_order_.pop_front();
  }
}

} // namespace dyncal::bus
