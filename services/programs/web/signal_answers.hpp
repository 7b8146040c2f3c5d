// Answers about samples: /api/bench/NAME/signal, spectrum and fit, and the signals of /events.
//
// A text of the same question is made at most once in 80 ms, regardless of who asks. Any thread.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include <httplib.h>

#include "services/programs/web/state_cache.hpp"
#include "services/views/signals/signal_tap.hpp"

namespace dyncal::inline programs::web {

class SignalAnswers {
public:
  // All outlive the object.
  SignalAnswers(StateCache& cache, SignalTap& tap, bus::Clock& clock)
      : cache_(cache), tap_(tap), clock_(clock) {}

  // False: the address is another's.
  [[nodiscard]] bool answer(const httplib::Request& request, httplib::Response& response);
  // Of the parameter signal=SOURCE/CHANNEL; null: there is no such channel.
  [[nodiscard]] Text signal(const std::string& bench, const httplib::Request& request);

private:
  struct Question {
    std::string bench;
    std::string source;
    std::string channel;
    double seconds = 10.0;
    std::size_t columns = 1000;
  };
  struct Found { // what the source says of the channel
    TappedChannel tapped;
    std::string unit;
    double minimum = 0.0;
    double maximum = 0.0;
  };

  [[nodiscard]] std::optional<Found> find(const Question& question) const;
  [[nodiscard]] Expected<nlohmann::ordered_json> spectrum(const Question& question);
  [[nodiscard]] Expected<nlohmann::ordered_json> fit(const std::string& bench);
  struct ExcitedStep;
  [[nodiscard]] std::optional<ExcitedStep> excited_step(const std::string& bench) const;
  [[nodiscard]] nlohmann::ordered_json
  fitted_json(const std::string& bench, const std::string& name, const ExcitedStep& step);
  [[nodiscard]] static Question question_of(const std::string& bench,
                                            const httplib::Request& request);

  struct Made {
    Text text;
    bus::Clock::Instant when;
  };
  static constexpr std::chrono::milliseconds text_age{80};
  static constexpr std::size_t max_texts = 64;

  StateCache& cache_;
  SignalTap& tap_;
  bus::Clock& clock_;
  std::mutex mutex_;
  std::map<std::string, Made> texts_;
};

} // namespace dyncal::inline programs::web
