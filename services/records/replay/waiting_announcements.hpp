// What the conductor of a recorded run said, until the samples it was said about have been handed
// to the evaluation.
//
// It counts in a source once two things hold. The source has sent something behind it in the file:
// how far a silent source was by then shows only when it sends again. And what was handed over of
// the source has come to the instant at which it was recorded: a recorder that was started again in
// the middle of a run stores what it missed behind announcements that are younger
// (RecordedPlace::sent_ns, by the recorder's clock). Sources that have ended are not waited for.
//
// Announcements are handed out in the order of the file. There are as many as the file holds, a few
// for each step. Belongs to one thread; does not fail.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <variant>

#include "idl/dyncal.h"
#include "services/evaluation/record/excitation_progress.hpp"

namespace dyncal::inline records {

class WaitingAnnouncements {
public:
  using Announcement = std::variant<StepAnnouncement, wire::MeasurementState>;

  // A message in the walk through the file: how many came before it, and its log_time in ns.
  struct Instant {
    std::uint64_t place = 0;
    std::int64_t time_ns = 0;
  };

  // From now on a source is waited for.
  void wait_for(const std::string& source) { reached_[source]; }
  // All that the source sent up to `sent_ns` is handed over; where the walk is now.
  void reach(const std::string& source, std::uint64_t place, std::int64_t sent_ns, bool is_ended);
  void add(const Instant& recorded, Announcement announcement);
  // Calls `take` with those that count, and when they were recorded; `at_once`: with all, whatever
  // the sources have sent.
  void hand_over(bool at_once,
                 const std::function<void(const Announcement&, std::int64_t recorded_ns)>& take);

private:
  struct Reached {
    std::uint64_t place = 0;
    std::int64_t sent_ns = 0;
    bool is_ended = false;
  };
  struct Waiting {
    Instant recorded;
    Announcement announcement;
  };

  [[nodiscard]] bool counts(const Instant& recorded) const;

  std::map<std::string, Reached> reached_;
  std::deque<Waiting> waiting_;
};

} // namespace dyncal::inline records
