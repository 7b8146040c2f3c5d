#include "services/run/guard_watch.hpp"

#include <fmt/format.h>

#include "services/bench/file/generator_address.hpp"

namespace dyncal::inline run {
namespace {

constexpr const char* consequence = "should this program, its host or its link fail, the exciter "
                                    "stays on";

} // namespace

void GuardWatch::take(const wire::ServiceStatus& status, Instant now) {
  const std::string service = status.service().to_string();
  if (status.guarded_generator().empty() ||
      (guards_.size() >= max_guards && !guards_.contains(service))) {
    return;
  }
  guards_[service] = {status.host(), status.run().to_string(), status.guarded_generator(),
                      status.health() == wire::HEALTH_FAILED ? status.message() : "", now};
}

std::string GuardWatch::failure(Instant now) const {
  for (const auto& [service, guard] : guards_) {
    if (now - guard.heard <= limit && !guard.message.empty() &&
        may_be_one_generator(guard.generator, generator_)) {
      return fmt::format("dyncal-guard on {}: {}", guard.host, guard.message);
    }
  }
  return "";
}

std::string GuardWatch::lack(Instant now) const {
  if (std::string failed = failure(now); !failed.empty()) {
    return failed;
  }
  const Guard* newest = nullptr;
  bool is_watched = false;
  for (const auto& [service, guard] : guards_) {
    is_watched = is_watched ||
                 (now - guard.heard <= limit && may_be_one_generator(guard.generator, generator_));
    if (newest == nullptr || newest->heard < guard.heard) {
      newest = &guard;
    }
  }
  if (is_watched) {
    return "";
  }
  if (newest == nullptr) {
    return now - since_ <= limit
               ? ""
               : fmt::format("no dyncal-guard watches over the exciter of bench '{}': {}; start "
                             "dyncal-guard with this bench file on a machine beside the generator",
                             bench_, consequence);
  }
  if (now - newest->heard <= limit) {
    return fmt::format("the dyncal-guard on {} switches off the generator at {}, and this run "
                       "drives the one at {}: unless they are one, {}; give both the same bench "
                       "file",
                       newest->host, newest->generator, generator_, consequence);
  }
  return fmt::format("the dyncal-guard on {} has gone silent: {}; look after it there",
                     newest->host, consequence);
}

std::string GuardWatch::deafness(const std::string& run, Instant now) const {
  // The last word of one that has gone silent holds until another is heard: where the way there is
  // lost, the way back may be lost a little later.
  const Guard* deaf = nullptr;
  bool is_heard_elsewhere = false;
  for (const auto& [service, guard] : guards_) {
    if (!may_be_one_generator(guard.generator, generator_)) {
      continue;
    }
    const bool is_there = now - guard.heard <= limit;
    if (guard.unheard == run && (deaf == nullptr || is_there)) {
      deaf = &guard;
    }
    is_heard_elsewhere = is_heard_elsewhere || (is_there && guard.unheard != run);
  }
  if (deaf == nullptr || (is_heard_elsewhere && now - deaf->heard > limit)) {
    return "";
  }
  return fmt::format("the dyncal-guard on {} does not hear this run and has switched the exciter "
                     "off, if it can: is the way from here to there open",
                     deaf->host);
}

std::optional<std::string> GuardWatch::notice(Instant now) {
  if (generator_.empty()) {
    return std::nullopt;
  }
  std::string sentence = lack(now);
  if (sentence == last_notice_) {
    return std::nullopt;
  }
  last_notice_ = std::move(sentence);
  return last_notice_.empty()
             ? fmt::format("a dyncal-guard watches over the exciter of bench '{}' now", bench_)
             : last_notice_;
}

} // namespace dyncal::inline run
