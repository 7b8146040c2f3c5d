// When the steps of a run were announced, in the clocks of its sources.
//
// Whoever conducts says that a step begins before its output is on, and that it is over when it is
// off. What a source's samples show in the middle of an excitation behind that instant, is of a
// later step. And what was announced in one instant, was so in both clocks: the difference of their
// stamps is the offset between them, to what samples are late; of several the median counts.
//
// Stamps are int64 ns in the clock of the source and its session; a new session may begin anew.
// Keeps an instant a step and source, and of the newest `max_sessions` pairs of sessions the newest
// `max_offsets`. Does not fail; belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace dyncal::services {

// Of one announcement in the clock of a source.
struct SourceInstant {
  std::int64_t stamp_ns = 0;
  // The source sent before and behind it without a break; else the stamp is of what it sent last,
  // or of just before its first sample.
  bool is_between_samples = true;
};

using SourceInstants = std::map<std::string, SourceInstant>; // by source

class AnnouncedInstants {
public:
  static constexpr std::size_t max_offsets = 64;
  static constexpr std::size_t max_sessions = 16;
  using Sessions = std::pair<std::uint32_t, std::uint32_t>; // of the first source and the second

  // The first instant that is given for a step counts.
  void add_over(const std::string& source, std::size_t step, std::int64_t stamp_ns) {
    over_ns_[source].emplace(step, stamp_ns);
  }
  // The clock of a source that restarts may begin anew, and that of one that has sent nothing
  // begins with its first sample.
  void follow(const std::string& source, std::int64_t newest_ns);
  [[nodiscard]] std::optional<std::int64_t> over_ns(const std::string& source,
                                                    std::size_t step) const;

  // Of the second clock behind the first.
  void add_offset(const Sessions& sessions, std::int64_t offset_ns);
  [[nodiscard]] std::optional<std::int64_t> offset_ns(const Sessions& sessions) const;

private:
  std::map<std::string, std::map<std::size_t, std::int64_t>> over_ns_;
  std::map<Sessions, std::deque<std::int64_t>> offsets_ns_;
};

} // namespace dyncal::services
