// The line between a free clock and the host's, from pairs of readings that are late by an amount
// that is never negative.
//
//   host = free (1 + rate) + offset + delay,   delay >= 0 (arbitration, interrupts, USB), often 0
//
// The line that lies below every point and has the least sum of distances to them is the edge of
// the lower convex hull of (free, host - free) above the mean of the points (Moon, Skelly, Towsley
// 1999): it follows the smallest delays and no mean of them. What remains is the smallest delay
// itself, which no reading can tell from the offset; the user of the line has to know it.
//
// Points are kept for `window_s` and the line is drawn again every `refresh_s`. Nothing is answered
// before `settle_s` and `settle_points`; at low rates older points are kept for it.
//
// A point that lies more than `step_s` below the line, or in the free clock before its predecessor,
// means that one of the clocks was set: the estimate starts over. A point far above is a late frame
// and changes nothing; but when `step_points` in a row are that far above, the host clock was set
// forward.
//
// Times are int64 ns; only their differences become double. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace dyncal::drivers::can {

struct ClockLineOptions {
  double window_s = 60.0;
  double refresh_s = 0.25;
  double settle_s = 1.0;
  std::size_t settle_points = 32;
  double step_s = 5e-3;
  std::size_t step_points = 200;
  double max_rate =
      500e-6; // of a clock that is no worse than its quartz, and of a nominal rate that is meant
};

class ClockLine {
public:
  explicit ClockLine(ClockLineOptions options = {}) : options_(options) {}

  // False: the estimate started over with this point.
  bool add(std::int64_t free_ns, std::int64_t host_ns);
  void restart();

  [[nodiscard]] bool ready() const { return ready_; }
  // REQUIRES: ready()
  [[nodiscard]] std::int64_t to_host(std::int64_t free_ns) const;
  [[nodiscard]] double rate() const { return rate_; }
  // Standard uncertainty of the line at its worse end, from the distance to it of four lines
  // through every fourth chunk of the points. The least delay of all is not in it.
  [[nodiscard]] double u_s() const { return u_s_; }
  [[nodiscard]] std::uint64_t restarts() const { return restarts_; }

private:
  struct Point {
    double free_s; // since the first point
    double difference_s;
  };
  struct Chunk {
    double begin_s = 0.0;
    double sum_free_s = 0.0;
    std::size_t points = 0;
    std::vector<Point> hull;
  };
  struct Line {
    double at_zero_s = 0.0;
    double slope = 0.0;
  };

  static void append(std::vector<Point>& hull, Point point);
  [[nodiscard]] bool stepped(const Point& point);
  void draw();
  [[nodiscard]] bool settled() const;
  [[nodiscard]] Line line_below(std::size_t first_chunk, std::size_t stride) const;

  ClockLineOptions options_;
  std::int64_t free_zero_ns_ = 0;
  std::int64_t host_zero_ns_ = 0;
  std::deque<Chunk> chunks_;
  double newest_free_s_ = 0.0;
  Line line_;
  double rate_ = 0.0;
  double u_s_ = 0.0;
  bool ready_ = false;
  std::size_t far_above_ = 0;
  std::uint64_t restarts_ = 0;
};

} // namespace dyncal::drivers::can
