#include "services/programs/analysis/source_stream.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace dyncal::inline programs {

bool SourceStream::is_triggered() const {
  return follower && std::holds_alternative<StreamFollower<wire::TriggeredRecord>>(*follower);
}

bool SourceStream::has_answered() const {
  return follower && std::visit([](const auto& one) { return one.answered(); }, *follower);
}

bool SourceStream::is_unfit(std::uint64_t session) const {
  return unfit && unfit->description.session() == session;
}

void SourceStream::take(const wire::SourceDescription& other) {
  description = other;
  described.add(other.session());
  // Samples of a session that was never described as anything else, or of another instrument, mean
  // nothing to the run.
  const auto replaced = std::exchange(unfit, std::nullopt);
  if (replaced &&
      (replaced->is_other_device || replaced->description.session() != other.session())) {
    waiting.leave_out_session(replaced->description.session());
  }
}

bool SourceStream::is_catching_up() const {
  return follower && std::visit([](const auto& one) { return one.catching_up(); }, *follower);
}

bool SourceStream::lacks_beginning() const {
  return follower && std::visit([](const auto& one) { return one.lacks_beginning(); }, *follower);
}

bool SourceStream::is_held_up(Instant now) const {
  return !follower || unfit || !waiting.empty() ||
         std::visit([&](const auto& one) { return one.silent(now); }, *follower);
}

std::uint64_t SourceStream::recovered() const {
  return follower ? std::visit([](const auto& one) { return one.recovered(); }, *follower) : 0;
}

std::optional<MissingSource> SourceStream::what_is_missing(const std::string& bench,
                                                           const std::string& name,
                                                           const KnownSource* known) const {
  const std::string place = fmt::format("source '{}' of bench '{}'", name, bench);
  if (known == nullptr) {
    return MissingSource{place + " is not on the network; is its service running with this bench "
                                 "file, in the same DDS domain?"};
  }
  if (known->says_that_it_is_silent()) {
    return MissingSource{place + " is silent" + known->reason_given()};
  }
  if (twins.twins() || known->twins.twins()) {
    return MissingSource{two_send_as(bench, name, service_before, service)};
  }
  if (unfit) {
    return MissingSource{unfit->why};
  }
  if (!follower) {
    return MissingSource{place + " has not described its channels yet" + known->reason_given(),
                         true, true};
  }
  if (!has_answered()) {
    return MissingSource{place + " does not answer in its sample stream; do samples get through "
                                 "from its host to this one?",
                         true};
  }
  return std::nullopt;
}

std::optional<LostSource> SourceStream::loss(const std::string& bench, const std::string& name,
                                             Instant now, const Patience& patience) const {
  const std::string place = fmt::format("source '{}' of bench '{}'", name, bench);
  if (is_triggered() && !second_writer.empty()) {
    return LostSource{second_writer, false};
  }
  if (twins.twins()) {
    return LostSource{two_send_as(bench, name, service_before, service), false};
  }
  if (unfit) {
    return LostSource{unfit->why, true, unfit->is_other_device};
  }
  if (is_undescribed) {
    return LostSource{place + " sends samples of a session that it has not described; they are "
                              "left out: start its service again"};
  }
  if (!follower) {
    return LostSource{place + " is not on the network"};
  }
  const bool ended = std::visit([](const auto& one) { return one.ended(); }, *follower);
  const auto heard = std::visit([](const auto& one) { return one.heard(); }, *follower);
  if (ended && patience.may_not_end) {
    return LostSource{place + " has ended before the run"};
  }
  if (!ended && !is_triggered() && now - std::max(heard, patience.from) > patience.limit) {
    return LostSource{fmt::format("{} has sent nothing for {} s", place, patience.limit.count())};
  }
  return std::nullopt;
}

} // namespace dyncal::inline programs
