#include "analysis/instrument/pulse_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace dyncal::analysis {
namespace {

constexpr std::uint64_t counter_period = std::uint64_t{1} << 32;
constexpr std::size_t edges_ahead =
    6; // of the same input, looked at to tell a glitch from a restart
constexpr std::int64_t max_gap_s = 3600;    // of a counter that does not wrap
constexpr double min_second_ticks = 1000.0; // a slower counter cannot stamp anything
constexpr std::array inputs{PulseInput::gps, PulseInput::reference};

std::size_t index_of(PulseInput input) {
  return static_cast<std::size_t>(input);
}

// The counter's arithmetic: differences of readings, unwrapped when the counter is one of 32 bits.
class Counter {
public:
  explicit Counter(std::span<const PulseEdge> record)
      : wraps_(std::all_of(record.begin(), record.end(),
                           [](const PulseEdge& edge) { return edge.ticks < counter_period; })) {}

  // From an edge to a later one of the same input.
  [[nodiscard]] std::int64_t onwards(const PulseEdge& from, const PulseEdge& to) const {
    const std::uint64_t difference = to.ticks - from.ticks;
    return static_cast<std::int64_t>(wraps_ ? difference % counter_period : difference);
  }
  // Between two edges recorded next to each other, in either order.
  [[nodiscard]] std::int64_t between(const PulseEdge& from, const PulseEdge& to) const {
    const std::int64_t difference = onwards(from, to);
    return wraps_ && difference >= static_cast<std::int64_t>(counter_period / 2)
               ? difference - static_cast<std::int64_t>(counter_period)
               : difference;
  }

private:
  bool wraps_;
};

// The length that most intervals agree on within the tolerance: a glitch spoils two intervals, so
// that a median may be none of a second.
double usual_interval(std::span<const PulseEdge> record, const Counter& counter,
                      double tolerance_s) {
  std::vector<double> intervals;
  std::array<const PulseEdge*, 2> last{};
  for (const PulseEdge& edge : record) {
    const PulseEdge*& before = last[index_of(edge.input)];
    if (before != nullptr) {
      intervals.push_back(static_cast<double>(counter.onwards(*before, edge)));
    }
    before = &edge;
  }
  std::sort(intervals.begin(), intervals.end());
  double usual = 0.0;
  std::size_t max_count = 0;
  for (std::size_t begin = 0, end = 0; begin < intervals.size(); ++begin) {
    while (end < intervals.size() && intervals[end] <= intervals[begin] * (1.0 + tolerance_s)) {
      ++end;
    }
    if (end - begin > max_count) {
      max_count = end - begin;
      usual = intervals[begin + max_count / 2];
    }
  }
  return usual;
}

class Sorter {
public:
  Sorter(std::span<const PulseEdge> record, double tolerance_s, double ticks_per_second)
      : record_(record), counter_(record), tolerance_s_(tolerance_s),
        second_ticks_(ticks_per_second) {
    for (std::size_t i = 0; i < record.size(); ++i) {
      of_input_[index_of(record[i].input)].push_back(i);
    }
  }

  SortedPulses sort() {
    sorted_.ticks_per_second = second_ticks_;
    for (std::size_t i = 0; i < record_.size(); ++i) {
      take(i);
      ++seen_[index_of(record_[i].input)];
    }
    return std::move(sorted_);
  }

private:
  struct Track {                          // of one input in the current session
    std::optional<std::size_t> last_edge; // on the grid
    Pulse last;
    std::optional<std::uint64_t> last_number;
    double second_ticks = 0.0;
  };

  // Whole seconds from one edge to another, or nothing when they are not on one grid.
  [[nodiscard]] std::optional<std::int64_t> seconds_between(std::size_t from, std::size_t to,
                                                            double second_ticks) const {
    const auto ticks = static_cast<double>(counter_.onwards(record_[from], record_[to]));
    const double seconds = std::round(ticks / second_ticks);
    const bool on_grid = seconds >= 1.0 && seconds <= static_cast<double>(max_gap_s) &&
                         std::abs(ticks - seconds * second_ticks) <= tolerance_s_ * second_ticks;
    return on_grid ? std::optional(static_cast<std::int64_t>(seconds)) : std::nullopt;
  }

  // One of the next edges of the input after `position` (in its own list) is whole seconds after
  // `from`.
  [[nodiscard]] bool grid_goes_on(PulseInput input, std::size_t position, std::size_t from,
                                  double second_ticks) const {
    const std::vector<std::size_t>& edges = of_input_[index_of(input)];
    const std::size_t end = std::min(edges.size(), position + edges_ahead);
    return std::any_of(edges.begin() + static_cast<std::ptrdiff_t>(std::min(position, end)),
                       edges.begin() + static_cast<std::ptrdiff_t>(end), [&](std::size_t edge) {
                         return seconds_between(from, edge, second_ticks).has_value();
                       });
  }

  [[nodiscard]] bool number_went_back(std::size_t i) const {
    const Track& track = tracks_[index_of(record_[i].input)];
    return track.last_number && record_[i].number < *track.last_number;
  }

  void report(PulseFault fault, std::size_t i, std::string reason, std::uint64_t missing = 0) {
    sorted_.events.push_back({fault, record_[i].input, i, missing, std::move(reason)});
  }

  void take(std::size_t i) {
    const PulseEdge& edge = record_[i];
    Track& track = tracks_[index_of(edge.input)];
    if (track.last_edge && record_[*track.last_edge].number == edge.number &&
        record_[*track.last_edge].ticks == edge.ticks) {
      return report(PulseFault::duplicate, i, "the edge before it again");
    }
    if (number_went_back(i)) {
      begin_session();
      report(PulseFault::session_restart, i, "the running number goes back");
    }
    track.last_number = edge.number;
    if (!track.last_edge) {
      return take_first(i, track);
    }
    if (const auto seconds = seconds_between(*track.last_edge, i, track.second_ticks)) {
      return take_on_grid(i, track, *seconds);
    }
    take_off_grid(i, track);
  }

  void take_first(std::size_t i, Track& track) {
    const PulseEdge& edge = record_[i];
    if (!grid_goes_on(edge.input, seen_[index_of(edge.input)] + 1, i, second_ticks_)) {
      return report(PulseFault::extra, i, "no edge follows it after whole seconds");
    }
    if (!session_open_) {
      sorted_.sessions.emplace_back();
    }
    session_open_ = true;
    // The other input's newest edge is the nearest point whose unwrapped reading is known.
    const Track& other = tracks_[1 - index_of(edge.input)];
    const std::int64_t ticks =
        other.last_edge ? other.last.ticks + counter_.between(record_[*other.last_edge], edge)
                        : std::int64_t{0};
    track.second_ticks = other.last_edge ? other.second_ticks : second_ticks_;
    keep(i, track, {ticks, 0, i});
  }

  void take_on_grid(std::size_t i, Track& track, std::int64_t seconds) {
    const std::int64_t ticks = counter_.onwards(record_[*track.last_edge], record_[i]);
    if (seconds > 1) {
      const auto missing = static_cast<std::uint64_t>(seconds - 1);
      report(PulseFault::missing, i, std::to_string(seconds) + " s after the edge before it",
             missing);
    }
    track.second_ticks = static_cast<double>(ticks) / static_cast<double>(seconds);
    keep(i, track, {track.last.ticks + ticks, track.last.second + seconds, i});
  }

  void take_off_grid(std::size_t i, Track& track) {
    const PulseInput input = record_[i].input;
    const std::size_t next = seen_[index_of(input)] + 1;
    const double apart_s =
        static_cast<double>(counter_.onwards(record_[*track.last_edge], record_[i])) /
        track.second_ticks;
    const std::string where = std::to_string(apart_s) + " s after the last second";
    if (grid_goes_on(input, next, *track.last_edge, track.second_ticks)) {
      return report(PulseFault::extra, i, where + ", the next seconds come in time");
    }
    if (!grid_goes_on(input, next, i, track.second_ticks)) {
      return report(PulseFault::extra, i, where + ", and no edge follows it after whole seconds");
    }
    const PulseInput other = inputs[1 - index_of(input)];
    const Track& other_track = tracks_[index_of(other)];
    if (other_track.last_edge && grid_goes_on(other, seen_[index_of(other)], *other_track.last_edge,
                                              other_track.second_ticks)) {
      report(PulseFault::pulse_step, i,
             where + ", and so are the next ones, while the other input goes on in time");
      const std::int64_t ticks = counter_.onwards(record_[*track.last_edge], record_[i]);
      return keep(i, track,
                  {track.last.ticks + ticks, track.last.second + std::llround(apart_s), i});
    }
    begin_session();
    track.last_number = record_[i].number;
    report(PulseFault::session_restart, i, where + " by the counter, and all further edges too");
    take_first(i, track);
  }

  void keep(std::size_t i, Track& track, const Pulse& pulse) {
    track.last_edge = i;
    track.last = pulse;
    PulseSession& session = sorted_.sessions.back();
    (record_[i].input == PulseInput::gps ? session.gps : session.reference).push_back(pulse);
  }

  void begin_session() {
    tracks_ = {};
    session_open_ = false;
  }

  std::span<const PulseEdge> record_;
  Counter counter_;
  double tolerance_s_;
  double second_ticks_;
  std::array<std::vector<std::size_t>, 2> of_input_;
  std::array<std::size_t, 2> seen_{};
  std::array<Track, 2> tracks_{};
  bool session_open_ = false;
  SortedPulses sorted_;
};

} // namespace

std::uint64_t SortedPulses::count(PulseFault fault, PulseInput input) const {
  std::uint64_t total = 0;
  for (const PulseEvent& event : events) {
    if (event.fault == fault && event.input == input) {
      total += fault == PulseFault::missing ? event.missing : 1;
    }
  }
  return total;
}

Expected<SortedPulses> sort_pulse_edges(std::span<const PulseEdge> record,
                                        const PulseEdgeSettings& settings) {
  if (!(settings.tolerance_s > 0.0 && settings.tolerance_s < 0.1)) {
    return fail(ErrorCode::invalid_argument,
                "the tolerance of a pulse must be above 0 and below 0.1 s");
  }
  const double second_ticks =
      record.size() < 3 ? 0.0 : usual_interval(record, Counter(record), settings.tolerance_s);
  if (!(second_ticks >= min_second_ticks)) {
    return fail(ErrorCode::too_few_samples, "the record has no edges that are a second apart");
  }
  SortedPulses sorted = Sorter(record, settings.tolerance_s, second_ticks).sort();
  std::size_t kept = 0;
  for (const PulseSession& session : sorted.sessions) {
    kept += session.gps.size() + session.reference.size();
  }
  // Any edges have a most usual distance: only when most of them lie on its grid is it a second.
  if (2 * kept < record.size()) {
    return fail(ErrorCode::too_few_samples, "most edges of the record are not whole seconds apart: "
                                            "is it a record of pulses per second?");
  }
  return sorted;
}

} // namespace dyncal::analysis
