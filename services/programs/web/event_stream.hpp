// Server-sent events (/events): each visitor gets the newest state, and again when it changes.
//
// A visitor is looked after by the thread of his connection: what he has had last is in there, so a
// slow one skips states, and nothing waits for him. A round lasts 100 ms for those who look at a
// signal and 250 ms for others; `laboratory` is written at least once a second, by which a visitor
// who has left is noticed. At most `max_listeners`; others are answered 503. Any thread.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include <httplib.h>

#include "services/programs/web/laboratory_answers.hpp"
#include "services/programs/web/request_router.hpp"
#include "services/programs/web/state_cache.hpp"

namespace dyncal::inline programs::web {

class EventStream {
public:
  static constexpr int max_listeners = 40; // of LimitedServer::max_threads
  static constexpr std::chrono::milliseconds state_round{250};
  static constexpr std::chrono::milliseconds signal_round{100};
  // The JSON of what /api/bench/NAME/signal answers to this request; null: nothing yet.
  using Signal = std::function<Text(const std::string& bench, const httplib::Request&)>;

  // All outlive the object.
  EventStream(StateCache& cache, const LaboratoryAnswers& answers, RequestRouter& router,
              Signal signal)
      : cache_(cache), answers_(answers), router_(router), signal_(std::move(signal)) {}

  // False: the address is another's.
  [[nodiscard]] bool answer(const httplib::Request& request, httplib::Response& response);
  [[nodiscard]] int listeners() const { return listeners_; }

private:
  struct Listener;

  [[nodiscard]] bool send_round(Listener& listener, httplib::DataSink& sink) const;
  void add_states(Listener& listener, std::string& events) const;
  [[nodiscard]] bool wait_for_round(Listener& listener) const;

  StateCache& cache_;
  const LaboratoryAnswers& answers_;
  RequestRouter& router_;
  Signal signal_;
  std::atomic<int> listeners_ = 0;
};

} // namespace dyncal::inline programs::web
