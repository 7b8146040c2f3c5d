#include "services/programs/analysis/stream_follower.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

#include "services/contract/number_in_source.hpp"

namespace dyncal::inline programs {
namespace {

constexpr std::size_t max_left_sessions = 64;

// Nothing for a message without a number.
template <class Message>
std::optional<StreamPosition> position_of(const Message& message) {
  const std::uint64_t number = contract::number_in_source(message);
  return number < contract::first_number(message)
             ? std::nullopt
             : std::optional(StreamPosition{message.session(), number});
}

template <class Message>
std::size_t bytes_of(const Message& message) {
  return sizeof(Message) + message.values().size() * sizeof(double);
}

} // namespace

std::size_t bytes_of(const wire::SampleBlock& block) {
  return sizeof(block) + block.values().size() * sizeof(double) +
         block.stamps_ns().size() * sizeof(std::int64_t) +
         block.stamp_uncertainty_ns().size() * sizeof(std::uint32_t) + block.stamp_flags().size();
}

template <class Message>
bool StreamFollower<Message>::is_known(const Message& message) const {
  const auto position = position_of(message);
  return position && newest_ &&
         (position->session == newest_->session ? position->number <= newest_->number
                                                : left_.contains(position->session));
}

template <class Message>
bool StreamFollower<Message>::follows(const Message& message) const {
  const auto position = position_of(message);
  if (!position || !newest_) {
    return true;
  }
  return position->session == newest_->session
             ? position->number == newest_->number + 1
             : position->number == contract::first_number(message);
}

template <class Message>
void StreamFollower<Message>::accept(const Message& message) {
  if (std::exchange(awaits_beginning_, false)) {
    lacks_beginning_ = message.acknowledged_run() != run_;
  }
  if (const auto position = position_of(message)) {
    if (newest_ && newest_->session != position->session) {
      left_.insert(newest_->session);
      if (left_.size() > max_left_sessions) {
        left_.erase(left_.begin());
      }
    }
    newest_ = position;
  }
  answered_ = true;
  ended_ = message.end_of_stream();
  hand_over_(message);
}

template <class Message>
void StreamFollower<Message>::hold(const Message& message) {
  held_bytes_ += bytes_of(message);
  held_.push_back(message);
  if (held_bytes_ > max_held_bytes) {
    held_.clear();
    held_bytes_ = 0;
  }
}

template <class Message>
bool StreamFollower<Message>::take_live(const Message& message, Instant now) {
  heard_ = now;
  if (request_) {
    hold(message);
  } else if (!answered_) {
    if (message.acknowledged_run() == run_) {
      accept(message);
    }
  } else if (follows(message)) {
    accept(message);
  } else if (!is_known(message)) {
    begin_catch_up(now);
    hold(message);
  } else {
    return false;
  }
  return true;
}

template <class Message>
void StreamFollower<Message>::take_again(const Message& message, Instant now) {
  if (!request_) {
    return;
  }
  request_->heard = now;
  if (message.sample_count() == 0 && message.acknowledged_run() == request_->name) {
    end_catch_up(now);
  } else if (!is_known(message)) {
    heard_ = now;
    accept(message);
    ++recovered_;
  }
}

template <class Message>
void StreamFollower<Message>::begin_catch_up(Instant now) {
  request_ = Request{.name = fmt::format("{} {}", asker_, ++requests_),
                     .behind = newest_,
                     .began = now,
                     .next_write = now,
                     .heard = std::nullopt};
}

// Of what is held, a jump that no answer has been asked about yet begins the next request.
template <class Message>
void StreamFollower<Message>::end_catch_up(Instant now) {
  answered_ = true;
  answered_behind_ = request_->behind;
  asked_ = now;
  request_.reset();
  held_bytes_ = 0;
  for (const Message& message : std::exchange(held_, {})) {
    if (request_) {
      hold(message);
    } else if (follows(message) || (!is_known(message) && answered_behind_ == newest_)) {
      accept(message);
    } else if (!is_known(message)) {
      begin_catch_up(now);
      hold(message);
    }
  }
}

template <class Message>
bool StreamFollower<Message>::silent(Instant now) const {
  return std::is_same_v<Message, wire::SampleBlock> && answered_ && !ended_ &&
         now - heard_ > silence_limit;
}

template <class Message>
std::optional<CatchUp> StreamFollower<Message>::due(Instant now) {
  if (!request_ && answered_ && !ended_ && now - std::max(heard_, asked_) > silence_limit) {
    begin_catch_up(now);
  }
  if (!request_) {
    return std::nullopt;
  }
  if (!request_->heard && !held_.empty() && now - request_->began > answer_limit) {
    end_catch_up(now);
    return due(now);
  }
  if (request_->heard && now - *request_->heard > stall_limit) {
    begin_catch_up(now);
  }
  if (request_->heard || now < request_->next_write) {
    return std::nullopt;
  }
  request_->next_write = now + request_interval;
  return CatchUp{request_->name, request_->behind.value_or(StreamPosition{})};
}

template class StreamFollower<wire::SampleBlock>;
template class StreamFollower<wire::TriggeredRecord>;

} // namespace dyncal::inline programs
