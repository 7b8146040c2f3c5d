#include "services/records/capture/source_gaps.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/core.h>

namespace dyncal::inline records::recording {
namespace {

constexpr std::size_t max_waiting = 16; // requests; an answer goes up to the newest message

} // namespace

bool SourceGaps::note(std::uint64_t session, std::uint64_t number) {
  const auto [found, is_new] = had_.try_emplace(session);
  if (is_new) {
    sessions_.push_back(session);
    if (sessions_.size() > max_sessions) {
      had_.erase(sessions_.front());
      sessions_.pop_front();
    }
  }
  auto& had = found->second.stretches;
  const auto behind = had.upper_bound(number);
  const auto before = behind == had.begin() ? had.end() : std::prev(behind);
  if (before != had.end() && before->second >= number) {
    return false;
  }
  std::uint64_t first = number;
  std::uint64_t last = number;
  if (before != had.end() && before->second + 1 == number) {
    first = before->first;
  }
  if (behind != had.end() && behind->first == number + 1) {
    last = behind->second;
    had.erase(behind);
  }
  had[first] = last;
  ++messages_;
  return true;
}

void SourceGaps::ask(std::uint64_t session, std::uint64_t number, Instant now) {
  Request request{fmt::format("{} {}", asker_, ++requests_), session, number};
  if (!active_) {
    active_ = Active{std::move(request), now, now, std::nullopt};
  } else if (waiting_.size() < max_waiting) {
    waiting_.push_back(std::move(request));
  }
}

bool SourceGaps::take_live(const Place& place, Instant now) {
  const auto [session, number, first_number] = place;
  const bool is_next_session = newest_ && !had_.contains(session);
  if (!note(session, number)) {
    return false;
  }
  if (is_next_session) {
    had_.at(session).begins_with = first_number;
  }
  const bool jumps = newest_ && newest_->first == session && number > newest_->second + 1;
  if (jumps || (is_next_session && number > first_number)) {
    ask(newest_->first, newest_->second, now);
  }
  if (!newest_ || newest_->first != session || number > newest_->second) {
    newest_ = {session, number};
  }
  return true;
}

bool SourceGaps::take_again(std::uint64_t session, std::uint64_t number, Instant now) {
  if (!active_) {
    return false;
  }
  active_->heard = now;
  const bool is_new = note(session, number);
  recovered_ += is_new ? 1 : 0;
  return is_new;
}

void SourceGaps::end_of_answer(const std::string& request) {
  if (active_ && active_->request.name == request) {
    active_.reset();
  }
}

void SourceGaps::ask_for_all(Instant now) {
  ask(0, 0, now);
}

std::optional<SourceGaps::Request> SourceGaps::due(Instant now) {
  const bool is_given_up = active_ && now - active_->heard.value_or(active_->began) >
                                          (active_->heard ? stall_limit : answer_limit);
  if (!active_ || is_given_up) {
    active_.reset();
    if (waiting_.empty()) {
      return std::nullopt;
    }
    active_ = Active{std::move(waiting_.front()), now, now + request_interval, std::nullopt};
    waiting_.pop_front();
    return active_->request;
  }
  if (active_->heard || now < active_->next_write) {
    return std::nullopt;
  }
  active_->next_write = now + request_interval;
  return active_->request;
}

std::uint64_t SourceGaps::missing() const {
  std::uint64_t missing = 0;
  for (const auto& [number, session] : had_) {
    const auto& had = session.stretches;
    const std::uint64_t begin = had.begin()->first;
    missing += begin - std::min(session.begins_with.value_or(begin), begin);
    for (auto stretch = had.begin(); stretch != had.end() && std::next(stretch) != had.end();
         ++stretch) {
      missing += std::next(stretch)->first - stretch->second - 1;
    }
  }
  return missing;
}

} // namespace dyncal::inline records::recording
