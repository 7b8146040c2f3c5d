#include "services/programs/web/event_stream.hpp"

#include <fmt/core.h>

namespace dyncal::inline programs::web {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds sign_of_life{1};

} // namespace

struct EventStream::Listener {
  httplib::Request request;
  std::string bench;
  bool wants_signal = false;
  bool is_first = true;
  Clock::time_point next_round{};
  Clock::time_point laboratory_sent{};
  std::uint64_t number = 0; // of the laboratory, as sent
  std::uint64_t results_number = 0;
  Text signal;
};

bool EventStream::answer(const httplib::Request& request, httplib::Response& response) {
  if (request.path != "/events") {
    return false;
  }
  if (++listeners_ > max_listeners) {
    --listeners_;
    response.set_header("Retry-After", "1");
    router_.refuse(Refusal::too_many_listeners, 503, "too many listen already; poll once a second",
                   request, response);
    return true;
  }
  auto listener = std::make_shared<Listener>();
  listener->request.params = request.params;
  listener->bench = request.get_param_value("bench");
  listener->wants_signal = !listener->bench.empty() && request.has_param("signal");
  response.set_header("X-Accel-Buffering", "no");
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, listener](std::size_t, httplib::DataSink& sink) {
        return wait_for_round(*listener) && send_round(*listener, sink);
      },
      [this](bool) { --listeners_; });
  return true;
}

// False: the daemon ends.
bool EventStream::wait_for_round(Listener& listener) const {
  const bool goes_on = router_.wait_until(listener.next_round);
  listener.next_round = Clock::now() + (listener.wants_signal ? signal_round : state_round);
  return goes_on;
}

void EventStream::add_states(Listener& listener, std::string& events) const {
  const std::uint64_t number = cache_.number();
  const auto now = Clock::now();
  const auto passed = now - listener.laboratory_sent;
  const bool is_due =
      passed >= sign_of_life || (number != listener.number && passed >= state_round);
  if (!is_due) {
    return;
  }
  const auto add = [&](const char* event, const Text& text) {
    if (text) {
      events += fmt::format("event: {}\nid: {}\ndata: {}\n\n", event, number, *text);
    }
  };
  add("laboratory", cache_.laboratory());
  listener.laboratory_sent = now;
  listener.number = number;
  if (listener.bench.empty()) {
    return;
  }
  add("bench", cache_.bench(listener.bench));
  const std::uint64_t results_number = cache_.results_number(listener.bench);
  if (results_number != listener.results_number || listener.is_first) {
    add("run", answers_.results(listener.bench, ""));
    listener.results_number = results_number;
  }
}

bool EventStream::send_round(Listener& listener, httplib::DataSink& sink) const {
  std::string events = listener.is_first ? "retry: 2000\n\n" : "";
  add_states(listener, events);
  if (listener.wants_signal) {
    const Text signal = signal_(listener.bench, listener.request);
    if (signal && signal != listener.signal) {
      events += fmt::format("event: signal\ndata: {}\n\n", *signal);
    }
    listener.signal = signal;
  }
  listener.is_first = false;
  return events.empty() || sink.write(events.data(), events.size());
}

} // namespace dyncal::inline programs::web
