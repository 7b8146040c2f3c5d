#include "services/evaluation/record/cut_step.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline evaluation {
namespace {

constexpr double margin_frames = 1.3;   // a frame at an edge counts when most of it is filled
constexpr std::int64_t edge_frames = 2; // an excitation so near to an end may be cut there
constexpr double max_unknown = 0.5;     // of the planned duration

double planned_ns(const RecipeStep& step) {
  return 1e9 * (step.settling_s + step.duration_s);
}

double beyond_plan_ns(const FoundExcitation& found, const RecipeStep& step) {
  return static_cast<double>(found.window.end_ns - found.window.begin_ns) - planned_ns(step);
}

bool ends_with_record(const FoundExcitation& last, const RecordedExcitations& record) {
  return record.recorded.end_ns - last.end_ns() < edge_frames * last.frame_ns;
}

} // namespace

bool begins_with_record(const FoundExcitation& first, std::int64_t record_begin_ns) {
  return first.begin_ns() - record_begin_ns < edge_frames * first.frame_ns;
}

std::optional<TimeInterval> evaluated_of_cut_step(const RecordedExcitations& record,
                                                  std::span<const RecipeStep* const> steps) {
  if (record.found.size() < 2 || steps.front() == nullptr ||
      !begins_with_record(record.found.front(), record.recorded.begin_ns)) {
    return std::nullopt;
  }
  std::vector<double> beyond_ns;
  double margin_ns = 0.0;
  for (std::size_t i = 1; i < record.found.size(); ++i) {
    if (steps[i] != nullptr && !ends_with_record(record.found[i], record)) {
      beyond_ns.push_back(beyond_plan_ns(record.found[i], *steps[i]));
      margin_ns =
          std::max(margin_ns, margin_frames * static_cast<double>(record.found[i].frame_ns));
    }
  }
  if (beyond_ns.empty()) {
    return std::nullopt;
  }
  const analysis::ExcitationWindow& window = record.found.front().window;
  const RecipeStep& step = *steps.front();
  const auto [least, most] = std::minmax_element(beyond_ns.begin(), beyond_ns.end());
  margin_ns =
      std::max(margin_ns, margin_frames * static_cast<double>(record.found.front().frame_ns));
  const double end_ns = static_cast<double>(window.end_ns - window.begin_ns) - planned_ns(step);
  // Of its beginning, from where what is there begins.
  const double earliest_ns = end_ns - *most - margin_ns;
  const double latest_ns = end_ns - *least + margin_ns;
  if (latest_ns >= 0.0 || latest_ns - earliest_ns > max_unknown * 1e9 * step.duration_s) {
    return std::nullopt;
  }
  const auto since_begin = [&begin_ns = window.begin_ns](double ns) {
    return begin_ns + static_cast<std::int64_t>(std::llround(ns));
  };
  return TimeInterval{std::max(window.begin_ns, since_begin(latest_ns + 1e9 * step.settling_s)),
                      std::min(window.end_ns, since_begin(earliest_ns + planned_ns(step))) - 1};
}

} // namespace dyncal::inline evaluation
