// A recorded source plays a run only as long as that lasts: while this lives, `token()` is
// requested to stop as soon as the run is over, another one is armed, or `stop` is requested.
//
// When the run is over, what the ring still holds of the play is thrown away: the next run begins
// with the beginning of the record. Made and destroyed by the thread that plays.
#pragma once

#include <stop_token>
#include <thread>

#include "services/stream/source_publisher.hpp"

namespace dyncal::inline stream {

class PlayOfRun {
public:
  // `publisher` outlives the object, and has returned the run from wait_for_run().
  PlayOfRun(SourcePublisher& publisher, const std::stop_token& stop)
      : publisher_(publisher), on_stop_(stop, Stopper{over_}),
        watch_([this](const std::stop_token& ended) {
          publisher_.wait_until_over(ended);
          if (!ended.stop_requested()) {
            over_.request_stop();
            publisher_.discard();
          }
        }) {}
  PlayOfRun(const PlayOfRun&) = delete;
  PlayOfRun& operator=(const PlayOfRun&) = delete;
  ~PlayOfRun() { publisher_.end_play(); }

  [[nodiscard]] std::stop_token token() const { return over_.get_token(); }

private:
  struct Stopper {
    std::stop_source over;
    void operator()() { over.request_stop(); }
  };

  SourcePublisher& publisher_;
  std::stop_source over_;
  std::stop_callback<Stopper> on_stop_;
  std::jthread watch_;
};

} // namespace dyncal::inline stream
