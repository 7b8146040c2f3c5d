#include "services/evaluation/record/shown_sine.hpp"

#include <algorithm>
#include <cmath>

#include "services/evaluation/record/good_samples.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double beside_mains_rel = 0.01; // of the frequency: mains are within it
constexpr std::int64_t edge_frames = 2;   // at either end, which the search does not fill

bool is_beside_mains(const Recipe& recipe, double hz) {
  return std::any_of(recipe.mains_hz.begin(), recipe.mains_hz.end(), [&](double line_hz) {
    const double harmonic_hz = line_hz * std::max(1.0, std::round(hz / line_hz));
    return std::abs(hz - harmonic_hz) < beside_mains_rel * hz;
  });
}

} // namespace

ShownSine shown_sine(const Recipe& recipe, const RunRecords& records, std::size_t step,
                     const ChannelName& channel) {
  const SourceRecord& record = records.of(channel.source);
  const auto column = record.channel(channel.channel);
  const auto stamps = record.stamps_ns();
  const TimeInterval where = records.where_missing(channel.source, step);
  if (!column || stamps.empty() || (record.forgotten() > 0 && stamps.front() > where.begin_ns)) {
    return ShownSine::unknown;
  }
  const analysis::Frequency& frequency = records.planned(step).frequency;
  analysis::ExcitationWindowFinder finder(frequency);
  push_good_samples(record, *column, {0, where.begin_ns, where.end_ns}, finder);
  finder.finish();
  const auto window = finder.window();
  if (!window) {
    return records.is_over_in(channel.source, step) ? ShownSine::not_shown : ShownSine::unknown;
  }
  const std::int64_t edge_ns = edge_frames * finder.frame_ns();
  const bool lasts_throughout =
      window->excited_begin_ns < std::max(where.begin_ns, stamps.front()) + edge_ns &&
      window->off_ns > std::min(where.end_ns, stamps.back()) - edge_ns;
  return lasts_throughout && is_beside_mains(recipe, frequency.hz()) ? ShownSine::not_shown
                                                                     : ShownSine::shown;
}

} // namespace dyncal::inline evaluation
