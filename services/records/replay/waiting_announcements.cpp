#include "services/records/replay/waiting_announcements.hpp"

#include <algorithm>

namespace dyncal::inline records {

void WaitingAnnouncements::reach(const std::string& source, std::uint64_t place,
                                 std::int64_t sent_ns, bool is_ended) {
  reached_[source] = {place, sent_ns, is_ended};
}

void WaitingAnnouncements::add(const Instant& recorded, Announcement announcement) {
  waiting_.push_back({recorded, std::move(announcement)});
}

void WaitingAnnouncements::hand_over(
    bool at_once, const std::function<void(const Announcement&, std::int64_t recorded_ns)>& take) {
  for (; !waiting_.empty() && (at_once || counts(waiting_.front().recorded));
       waiting_.pop_front()) {
    take(waiting_.front().announcement, waiting_.front().recorded.time_ns);
  }
}

bool WaitingAnnouncements::counts(const Instant& recorded) const {
  return std::ranges::all_of(reached_, [&recorded](const auto& source) {
    const Reached& reached = source.second;
    return reached.is_ended ||
           (reached.place > recorded.place && reached.sent_ns >= recorded.time_ns);
  });
}

} // namespace dyncal::inline records
