#include "services/stream/catch_up_server.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "services/contract/topics.hpp"

namespace dyncal::inline stream {

namespace {

constexpr auto tidy_interval = std::chrono::milliseconds(500);
constexpr auto answer_interval = std::chrono::milliseconds(5); // to look for acknowledgments again
constexpr std::size_t max_asked = 256;                         // requests remembered
constexpr std::size_t max_request = 256;                       // bytes of a request's name

CatchUpOptions to_wish(const wire::CatchUpRequest& message) {
  return {.asker = message.asker().c_str(),
          .request = message.request(),
          .run = message.run(),
          .session = message.session(),
          .after = message.after()};
}

} // namespace

CatchUpServer::CatchUpServer(bus::Participant& participant, bus::Clock& clock)
    : participant_(participant), clock_(clock), wake_up_(std::make_shared<bus::WakeUp>()) {}

Expected<void> CatchUpServer::add(const SourceOptions& source,
                                  std::shared_ptr<RetransmissionBuffer> kept) {
  if (!requests_.contains(source.bench)) {
    DYNCAL_TRY(auto reader,
               participant_.reader(bus::topics::catch_up_request, source.bench, wake_up_));
    requests_.emplace(source.bench, std::move(reader));
  }
  sources_.push_back({source, std::move(kept), {}});
  return {};
}

CatchUpServer::Asked CatchUpServer::asked(const Source& source, const CatchUpOptions& wish) {
  return {source.options.bench + '\n' + source.options.source, wish.asker, wish.request};
}

std::size_t CatchUpServer::answers() const {
  std::size_t count = 0;
  for (const Source& source : sources_) {
    count += source.answers.size();
  }
  return count;
}

void CatchUpServer::take_requests(const std::string& bench,
                                  bus::Reader<wire::CatchUpRequest>& reader) {
  reader.take([&](const wire::CatchUpRequest& message) {
    if (message.bench() != bench || message.request().empty() ||
        message.request().size() > max_request) {
      return;
    }
    for (Source& source : sources_) {
      if (source.options.bench == bench && source.options.source == message.source().c_str()) {
        begin(source, to_wish(message));
      }
    }
  });
}

void CatchUpServer::begin(Source& source, CatchUpOptions wish) {
  const Asked asked = this->asked(source, wish);
  if (std::ranges::count(asked_, asked) != 0) {
    return;
  }
  std::erase_if(source.answers,
                [&](const auto& answer) { return answer->wish().asker == wish.asker; });
  if (answers() >= max_answers) {
    return;
  }
  asked_.push_back(asked);
  if (asked_.size() > max_asked) {
    asked_.pop_front();
  }
  auto writer = CatchUpWriter::create(participant_, source.options, wish.asker);
  if (!writer) {
    spdlog::warn("{}/{}: cannot answer {}: {}", source.options.bench, source.options.source,
                 wish.asker, writer.error().message);
    return;
  }
  source.answers.push_back(std::make_unique<CatchUpAnswer>(std::move(wish), source.kept,
                                                           std::move(*writer), clock_.now()));
}

// Returns false if there is none left.
bool CatchUpServer::step_answers(Source& source) {
  std::erase_if(source.answers, [&](const auto& answer) {
    const auto state = answer->step(clock_.now());
    if (state == CatchUpAnswer::State::broken_off) {
      std::erase(asked_, asked(source, answer->wish()));
    }
    if (state != CatchUpAnswer::State::broken_off && state != CatchUpAnswer::State::given) {
      return false;
    }
    if (answer->messages_given() > 0) {
      spdlog::info("{}/{}: {} messages were given again to {}{}", source.options.bench,
                   source.options.source, answer->messages_given(), answer->wish().asker,
                   state == CatchUpAnswer::State::given ? "" : ", who has gone");
    }
    return true;
  });
  return !source.answers.empty();
}

bus::Clock::Instant CatchUpServer::step() {
  for (auto& [bench, reader] : requests_) {
    take_requests(bench, reader);
  }
  bool answering = false;
  for (Source& source : sources_) {
    source.kept->tidy(clock_.now());
    answering = step_answers(source) || answering;
  }
  return clock_.now() + (answering ? answer_interval : tidy_interval);
}

} // namespace dyncal::inline stream
