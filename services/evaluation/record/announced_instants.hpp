// When the steps of a run were announced, in the clocks of its sources.
//
// Whoever conducts says that a step begins before its output is on, and that it is over when it is
// off. What a source's samples show in the middle of an excitation behind that instant, is of a
// later step. And what was heard in one instant, was so in both clocks: the difference of their
// stamps is the offset between them; of several the median counts.
//
// In a clock an instant is known by when blocks were sent (sent_blocks.hpp); a service that was
// stopped sends what its instrument has measured late, and nothing but the time that it has gone on
// since tells so. Where nobody says when anything was sent, an instant is taken for the newest
// stamp that had come when the announcement was handed over: then, and in an earlier session of a
// source, it is only as good as its samples came soon.
//
// Stamps are int64 ns in the clock of the source and its session; a new session may begin anew.
// Keeps an instant a step and source, the newest `max_heard` announcements, and of the newest
// `max_sessions` pairs of sessions the newest `max_heard` offsets. Does not fail; one thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "services/evaluation/record/sent_blocks.hpp"

namespace dyncal::inline evaluation {

class AnnouncedInstants {
public:
  static constexpr std::size_t max_heard = 64;
  static constexpr std::size_t max_sessions = 16;
  using Sessions = std::pair<std::uint32_t, std::uint32_t>; // of the first source and the second
  using Sources = std::pair<std::string, std::string>;

  void add(const std::string& source, const SourceBlock& block, const BlockTimes& times);
  void hear(std::int64_t heard_ns);

  // The first instant that is given for a step counts. By the newest stamp that has come:
  void add_over(const std::string& source, std::size_t step, std::int64_t newest_ns) {
    newest_when_over_ns_[source].emplace(step, newest_ns);
  }
  void add_over(std::size_t step, std::int64_t heard_ns);
  // The clock of a source that restarts may begin anew, and that of one that has sent nothing
  // begins with its first sample.
  void follow(const std::string& source, std::int64_t newest_ns);
  [[nodiscard]] std::optional<std::int64_t> newest_when_over_ns(const std::string& source,
                                                                std::size_t step) const;
  // As well as it is known.
  [[nodiscard]] std::optional<std::int64_t> over_ns(const std::string& source,
                                                    std::size_t step) const;

  // Blocks of the source were heard so long after all that had been heard when the step was known
  // to be over; true where no time is known.
  [[nodiscard]] bool has_gone_on(const std::string& source, std::size_t step,
                                 std::chrono::nanoseconds duration) const;

  // Of the second clock behind the first, by the newest stamps that have come.
  void add_offset(const Sessions& sessions, std::int64_t offset_ns);
  // REQUIRES: sessions that were given an offset, or the present ones of the sources.
  [[nodiscard]] std::optional<std::int64_t> offset_ns(const Sources& sources,
                                                      const Sessions& sessions) const;

private:
  [[nodiscard]] std::optional<std::int64_t> offset_by_sent_blocks(const Sources& sources) const;

  std::map<std::string, SentBlocks> sent_;
  std::deque<std::int64_t> heard_ns_;
  std::map<std::size_t, std::int64_t> over_heard_ns_;
  std::map<std::string, std::int64_t> newest_heard_ns_; // of blocks
  std::map<std::size_t, std::int64_t> over_known_ns_;   // newest of all that was heard by then
  std::map<std::string, std::map<std::size_t, std::int64_t>> newest_when_over_ns_;
  std::map<Sessions, std::deque<std::int64_t>> offsets_ns_;
};

} // namespace dyncal::inline evaluation
