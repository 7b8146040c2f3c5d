#include "services/programs/guard/believed_conductor.hpp"

#include <type_traits>

namespace dyncal::inline programs {
namespace {

constexpr auto excitation = static_cast<std::size_t>(ChainTopic::excitation);

std::uint64_t during(bus::Clock::Instant from, bus::Clock::Instant to, std::uint64_t per_s) {
  const auto passed = std::chrono::duration_cast<std::chrono::milliseconds>(to - from).count();
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, passed)) * per_s / 1000;
}

template <class Message>
std::optional<NumberedLink> shown_by(const Message& message) {
  const auto link = parse_chain_link(message.link());
  return link ? std::optional(NumberedLink{message.link_number(), *link}) : std::nullopt;
}

template <class Message>
Conductor beginning_of(const Message& message, const bus::WriterId& writer) {
  Conductor conductor{message.run().to_string(), writer.participant()};
  if constexpr (std::is_same_v<Message, wire::Measurement>) {
    if (const auto anchor = parse_chain_link(message.excitation_anchor())) {
      conductor.links[excitation] = NumberedLink{0, *anchor};
    }
  }
  return conductor;
}

} // namespace

std::uint64_t BelievedConductor::most_links(ChainTopic topic, Instant now) const {
  const auto place = static_cast<std::size_t>(topic);
  const std::uint64_t most =
      is_followed_[place] ? spare_links + during(heard_[place], now, links_per_s) : most_links_ever;
  return std::min(most, hashes_left_);
}

bool BelievedConductor::is_next(ChainTopic topic, const std::optional<NumberedLink>& shown,
                                Instant now) {
  const auto place = static_cast<std::size_t>(topic);
  std::optional<NumberedLink>& latest = conductor_.links[place];
  if (!latest) {
    latest = shown; // nothing of contract 2
    return true;
  }
  hashes_left_ = std::min(most_links_ever, hashes_left_ + during(refilled_, now, hashes_per_s));
  refilled_ = now;
  const std::uint64_t most = most_links(topic, now);
  if (!shown || shown->number <= latest->number || shown->number - latest->number > most) {
    return false;
  }
  hashes_left_ -= shown->number - latest->number;
  ChainFollower follower(*latest);
  if (!follower.accept(*shown, most)) {
    return false;
  }
  latest = follower.latest();
  return true;
}

template <class Message>
bool BelievedConductor::believes(const Message& message, ChainTopic topic,
                                 const bus::WriterId& writer, bool may_change, Instant now) {
  const auto place = static_cast<std::size_t>(topic);
  const auto shown = shown_by(message);
  const bool is_told_by_link = !writer.is_known() && shown && conductor_.links[place];
  const bool is_of_conductor =
      message.run().to_string() == conductor_.run &&
      (is_told_by_link || (writer.is_known() && writer.participant() == conductor_.participant));
  bool is_believed = is_of_conductor && is_next(topic, shown, now);
  if (!is_believed && may_change && writer.is_known()) {
    conductor_ = beginning_of(message, writer);
    is_followed_ = {};
    is_believed = is_next(topic, shown, now);
  }
  if (!is_believed) {
    ++passed_over_;
    return false;
  }
  heard_[place] = now;
  is_followed_[place] = true;
  return true;
}

bool BelievedConductor::believes(const wire::Measurement& measurement, const bus::WriterId& writer,
                                 bool may_change, Instant now) {
  return believes(measurement, ChainTopic::measurement, writer, may_change, now);
}

bool BelievedConductor::believes(const wire::Excitation& message, const bus::WriterId& writer,
                                 bool may_change, Instant now) {
  return believes(message, ChainTopic::excitation, writer, may_change, now);
}

} // namespace dyncal::inline programs
