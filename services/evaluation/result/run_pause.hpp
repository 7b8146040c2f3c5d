// When a run stood still and why, as results, certificates and recordings tell it.
//
// A reason that comes again with other numbers in it (how long something has been away) is the same
// pause; another reason begins another, where the one before ends.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dyncal::inline evaluation {

// A time in which nothing was excited, for something was away or somebody asked for it.
struct RunPause {
  std::int64_t began_utc_ns = 0;
  std::int64_t ended_utc_ns = 0; // 0: not yet
  std::string reason;
};

[[nodiscard]] bool is_same_reason(const std::string& one, const std::string& other);
// The run stands still for this reason.
void note_pause(std::vector<RunPause>& pauses, std::int64_t now_utc_ns, const std::string& reason);
// It goes on, if it has stood still.
void end_pause(std::vector<RunPause>& pauses, std::int64_t now_utc_ns);

} // namespace dyncal::inline evaluation
