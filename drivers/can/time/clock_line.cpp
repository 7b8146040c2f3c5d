#include "drivers/can/time/clock_line.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::drivers::can {

namespace {

// The smallest of n delays lies above the least possible one by something like 1/n of their spread,
// and is as uncertain as that. A line through one of g groups of the points lies g times as far
// above, and (g - 1) times as far above the line through all. The mean over the groups is known to
// some half of itself only, which the factor of 2 covers.
constexpr std::size_t groups = 4;
constexpr double coverage = 2.0;

} // namespace

void ClockLine::restart() {
  chunks_.clear();
  ready_ = false;
  far_above_ = 0;
  rate_ = 0.0;
  u_s_ = 0.0;
  ++restarts_;
}

// Keeps only points from which the rest is seen below: the lower hull, for points that come in
// order.
void ClockLine::append(std::vector<Point>& hull, Point point) {
  const auto above_chord = [](const Point& a, const Point& b, const Point& c) {
    return (b.difference_s - a.difference_s) * (c.free_s - a.free_s) >=
           (c.difference_s - a.difference_s) * (b.free_s - a.free_s);
  };
  if (!hull.empty() && point.free_s == hull.back().free_s) {
    if (point.difference_s >= hull.back().difference_s) {
      return;
    }
    hull.pop_back();
  }
  while (hull.size() >= 2 && above_chord(hull[hull.size() - 2], hull.back(), point)) {
    hull.pop_back();
  }
  hull.push_back(point);
}

bool ClockLine::stepped(const Point& point) {
  if (point.free_s < newest_free_s_) {
    return true;
  }
  if (!ready_) {
    return false;
  }
  const double delay_s = point.difference_s - (line_.at_zero_s + line_.slope * point.free_s);
  if (delay_s < -options_.step_s) {
    return true;
  }
  far_above_ = delay_s > options_.step_s ? far_above_ + 1 : 0;
  return far_above_ >= options_.step_points;
}

bool ClockLine::add(std::int64_t free_ns, std::int64_t host_ns) {
  const bool begun = !chunks_.empty();
  if (begun) {
    const Point point{static_cast<double>(free_ns - free_zero_ns_) * 1e-9,
                      static_cast<double>((host_ns - host_zero_ns_) - (free_ns - free_zero_ns_)) *
                          1e-9};
    if (!stepped(point)) {
      newest_free_s_ = point.free_s;
      if (point.free_s - chunks_.back().begin_s >= options_.refresh_s) {
        draw();
        chunks_.push_back({point.free_s, 0.0, 0, {}});
        while (chunks_.size() > options_.settle_points &&
               point.free_s - chunks_.front().begin_s > options_.window_s) {
          chunks_.pop_front();
        }
      }
      Chunk& chunk = chunks_.back();
      append(chunk.hull, point);
      chunk.sum_free_s += point.free_s;
      ++chunk.points;
      return true;
    }
    restart();
  }
  free_zero_ns_ = free_ns;
  host_zero_ns_ = host_ns;
  newest_free_s_ = 0.0;
  chunks_.push_back({0.0, 0.0, 1, {{0.0, 0.0}}});
  return !begun;
}

ClockLine::Line ClockLine::line_below(std::size_t first_chunk, std::size_t stride) const {
  std::vector<Point> hull;
  double sum_s = 0.0;
  double points = 0.0;
  for (std::size_t i = first_chunk; i < chunks_.size(); i += stride) {
    for (const Point& point : chunks_[i].hull) {
      append(hull, point);
    }
    sum_s += chunks_[i].sum_free_s;
    points += static_cast<double>(chunks_[i].points);
  }
  if (hull.size() < 2) {
    return {hull.empty() ? 0.0 : hull.front().difference_s, 0.0};
  }
  const double mean_s = sum_s / points;
  std::size_t right = 1;
  while (right + 1 < hull.size() && hull[right].free_s < mean_s) {
    ++right;
  }
  const Point& a = hull[right - 1];
  const Point& b = hull[right];
  const double slope = std::clamp((b.difference_s - a.difference_s) / (b.free_s - a.free_s),
                                  -options_.max_rate, options_.max_rate);
  // A slope that had to be limited goes through the lowest point that it then touches.
  double at_zero = a.difference_s - slope * a.free_s;
  for (const Point& point : hull) {
    at_zero = std::min(at_zero, point.difference_s - slope * point.free_s);
  }
  return {at_zero, slope};
}

bool ClockLine::settled() const {
  if (chunks_.size() < groups || newest_free_s_ - chunks_.front().begin_s < options_.settle_s) {
    return false;
  }
  std::size_t points = 0;
  for (const Chunk& chunk : chunks_) {
    points += chunk.points;
  }
  return points >= options_.settle_points;
}

void ClockLine::draw() {
  if (!ready_ && !settled()) {
    return;
  }
  line_ = line_below(0, 1);
  rate_ = line_.slope;
  ready_ = true;
  double distance_at_end_s = 0.0;
  double distance_at_begin_s = 0.0;
  for (std::size_t group = 0; group < groups; ++group) {
    const Line of_group = line_below(group, groups);
    const auto distance_s = [&](double at_s) {
      return std::abs(of_group.at_zero_s - line_.at_zero_s + (of_group.slope - line_.slope) * at_s);
    };
    distance_at_end_s += distance_s(newest_free_s_);
    distance_at_begin_s += distance_s(chunks_.front().begin_s);
  }
  u_s_ = coverage * std::max(distance_at_end_s, distance_at_begin_s) / (groups * (groups - 1.0));
}

std::int64_t ClockLine::to_host(std::int64_t free_ns) const {
  const std::int64_t since_zero_ns = free_ns - free_zero_ns_;
  const double difference_s =
      line_.at_zero_s + line_.slope * static_cast<double>(since_zero_ns) * 1e-9;
  return host_zero_ns_ + since_zero_ns +
         static_cast<std::int64_t>(std::llround(difference_s * 1e9));
}

} // namespace dyncal::drivers::can
