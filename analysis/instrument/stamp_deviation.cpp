#include "analysis/instrument/stamp_deviation.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <span>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t figures_of_clock = 60;
constexpr std::size_t trusted_figures = 2;
constexpr std::size_t min_blocks = 16;
constexpr std::size_t min_allan_terms = 8;

// The unit's clock as its firmware keeps it: origin and rate from the GPS edges up to now.
class UnitClock {
public:
  void take(const Pulse& pulse) {
    if (origin_ && pulse.second == origin_->second + 1) {
      figures_.push_back(static_cast<double>(pulse.ticks - origin_->ticks));
      if (figures_.size() > figures_of_clock) {
        figures_.pop_front();
      }
    }
    origin_ = pulse;
  }
  [[nodiscard]] bool trusted() const { return figures_.size() >= trusted_figures; }
  [[nodiscard]] double ticks_per_second() const {
    return std::accumulate(figures_.begin(), figures_.end(), 0.0) /
           static_cast<double>(figures_.size());
  }
  [[nodiscard]] const Pulse& origin() const { return *origin_; }

private:
  std::optional<Pulse> origin_;
  std::deque<double> figures_;
};

struct Raw { // t_n - n of one reference edge
  StampDeviation at;
  std::int64_t whole_s = 0; // the whole seconds of the session's numbering are taken off
  double rest_s = 0.0;
  std::int64_t second = 0; // of the reference
};

double u_mean_by_blocks(std::vector<double> blocks) {
  double u = standard_deviation(blocks) / std::sqrt(static_cast<double>(blocks.size()));
  while (blocks.size() / 2 >= min_blocks) {
    for (std::size_t i = 0; i < blocks.size() / 2; ++i) {
      blocks[i] = 0.5 * (blocks[2 * i] + blocks[2 * i + 1]);
    }
    blocks.resize(blocks.size() / 2);
    u = std::max(u, standard_deviation(blocks) / std::sqrt(static_cast<double>(blocks.size())));
  }
  return u;
}

double effective_count(const std::vector<double>& values, double u_mean) {
  const double sd = standard_deviation(values);
  return u_mean > 0.0
             ? std::clamp(sd * sd / (u_mean * u_mean), 1.0, static_cast<double>(values.size()))
             : static_cast<double>(values.size());
}

// Stamps of one session's reference edges, counted from the session's own first seconds.
void stamp_session(const PulseSession& session, std::size_t number, double begin_s,
                   double ticks_per_second, std::vector<Raw>& raws, std::size_t& untrusted) {
  UnitClock clock;
  auto gps = session.gps.begin();
  for (const Pulse& pulse : session.reference) {
    for (; gps != session.gps.end() && gps->ticks <= pulse.ticks; ++gps) {
      clock.take(*gps);
    }
    if (!clock.trusted()) {
      ++untrusted;
      continue;
    }
    const double since_origin_s =
        static_cast<double>(pulse.ticks - clock.origin().ticks) / clock.ticks_per_second();
    const double time_s = begin_s + static_cast<double>(pulse.ticks) / ticks_per_second;
    raws.push_back({{number, time_s, 0.0, pulse.edge},
                    clock.origin().second - pulse.second,
                    since_origin_s,
                    pulse.second});
  }
}

double length_s(const PulseSession& session, double ticks_per_second) {
  std::int64_t last = 0;
  for (const auto* pulses : {&session.gps, &session.reference}) {
    if (!pulses->empty()) {
      last = std::max(last, pulses->back().ticks);
    }
  }
  return static_cast<double>(last) / ticks_per_second;
}

// Sessions number their seconds anew: whole seconds are taken off so that all lie within half a
// second of the offset, or of the first.
void remove_whole_seconds(std::vector<Raw>& raws, std::optional<double> offset_s) {
  std::size_t session = 0;
  std::int64_t whole_s = 0;
  double near_s = 0.0;
  for (Raw& raw : raws) {
    if (&raw == &raws.front() || raw.at.session != session) {
      session = raw.at.session;
      if (&raw == &raws.front()) {
        near_s = offset_s.value_or(raw.rest_s - std::floor(raw.rest_s + 0.5));
      }
      whole_s = raw.whole_s + std::llround(raw.rest_s - near_s);
    }
    raw.rest_s += static_cast<double>(raw.whole_s - whole_s);
  }
}

void add_drift(StampDeviationStatistics& statistics, const std::vector<double>& deviations_s) {
  const std::size_t sessions = statistics.deviations.back().session + 1;
  std::vector<double> counts(sessions, 0.0), times(sessions, 0.0), means(sessions, 0.0);
  for (const StampDeviation& one : statistics.deviations) {
    counts[one.session] += 1.0;
    times[one.session] += one.time_s;
    means[one.session] += one.deviation_s;
  }
  double squares = 0.0, products = 0.0;
  const auto centred_time = [&](const StampDeviation& one) {
    return one.time_s - times[one.session] / counts[one.session];
  };
  const auto centred_deviation = [&](const StampDeviation& one) {
    return one.deviation_s - means[one.session] / counts[one.session];
  };
  for (const StampDeviation& one : statistics.deviations) {
    squares += centred_time(one) * centred_time(one);
    products += centred_time(one) * centred_deviation(one);
  }
  if (!(squares > 0.0) || deviations_s.size() < 4) {
    return;
  }
  statistics.drift = products / squares;
  std::vector<double> residuals;
  for (const StampDeviation& one : statistics.deviations) {
    residuals.push_back(centred_deviation(one) - statistics.drift * centred_time(one));
  }
  const double inflation = static_cast<double>(residuals.size()) /
                           effective_count(residuals, u_mean_by_blocks(residuals));
  statistics.u_drift = standard_deviation(residuals) * std::sqrt(inflation / squares);
}

std::vector<AllanPoint> allan_of_max_stretch(const std::vector<Raw>& raws) {
  std::size_t max_begin = 0, longest = 0;
  for (std::size_t begin = 0, i = 0; i < raws.size(); ++i) {
    const bool follows = i > begin && raws[i].at.session == raws[i - 1].at.session &&
                         raws[i].second == raws[i - 1].second + 1;
    if (!follows) {
      begin = i;
    }
    if (i + 1 - begin > longest) {
      longest = i + 1 - begin;
      max_begin = begin;
    }
  }
  std::vector<double> phases_s;
  for (std::size_t i = 0; i < longest; ++i) {
    phases_s.push_back(raws[max_begin + i].rest_s - raws[max_begin].rest_s);
  }
  std::vector<AllanPoint> points;
  for (std::size_t m = 1; phases_s.size() >= 2 * m + std::max(m, min_allan_terms); m *= 2) {
    points.push_back({static_cast<double>(m), overlapping_allan_deviation(phases_s, 1.0, m)});
  }
  return points;
}

} // namespace

std::optional<PulsePrediction> predict_gps_pulses(const SortedPulses& pulses) {
  std::vector<double> predictions_s, ticks;
  for (const PulseSession& session : pulses.sessions) {
    UnitClock clock;
    for (const Pulse& pulse : session.gps) {
      if (clock.trusted() && pulse.second == clock.origin().second + 1) {
        const auto second = static_cast<double>(pulse.ticks - clock.origin().ticks);
        predictions_s.push_back(second / clock.ticks_per_second() - 1.0);
        ticks.push_back(second);
      }
      clock.take(pulse);
    }
  }
  if (predictions_s.size() < 2) {
    return std::nullopt;
  }
  const auto [minimum, maximum] = std::minmax_element(predictions_s.begin(), predictions_s.end());
  return PulsePrediction{
      predictions_s.size(), standard_deviation(predictions_s), *minimum, *maximum,
      mean(ticks),          standard_deviation(ticks)};
}

Expected<StampDeviationStatistics> stamp_deviations(const SortedPulses& pulses,
                                                    const StampDeviationSettings& settings) {
  if (!(settings.u_reference_s >= 0.0)) {
    return fail(ErrorCode::invalid_argument,
                "the uncertainty of the reference pulse must not be negative");
  }
  StampDeviationStatistics statistics;
  std::vector<Raw> raws;
  double begin_s = 0.0;
  for (std::size_t i = 0; i < pulses.sessions.size(); ++i) {
    stamp_session(pulses.sessions[i], i, begin_s, pulses.ticks_per_second, raws,
                  statistics.untrusted);
    begin_s += length_s(pulses.sessions[i], pulses.ticks_per_second) + 1.0;
  }
  if (raws.size() < 3) {
    return fail(ErrorCode::too_few_samples,
                "fewer than three edges of the reference pulse have a stamp");
  }
  remove_whole_seconds(raws, settings.reference_offset_s);
  std::vector<double> deviations_s;
  for (const Raw& raw : raws) {
    deviations_s.push_back(raw.rest_s);
  }
  statistics.reference_offset_s = settings.reference_offset_s.value_or(mean(deviations_s));
  for (std::size_t i = 0; i < raws.size(); ++i) {
    deviations_s[i] -= statistics.reference_offset_s;
    raws[i].at.deviation_s = deviations_s[i];
    statistics.deviations.push_back(raws[i].at);
  }
  statistics.mean_s = settings.reference_offset_s ? mean(deviations_s) : 0.0;
  statistics.sd_s = standard_deviation(deviations_s);
  const double u_mean_s = u_mean_by_blocks(deviations_s);
  statistics.u_mean_s = std::hypot(u_mean_s, settings.u_reference_s);
  statistics.effective_count = effective_count(deviations_s, u_mean_s);
  statistics.u_sd_s =
      statistics.sd_s / std::sqrt(2.0 * std::max(statistics.effective_count - 1.0, 1.0));
  statistics.u_stamp_s = std::hypot(statistics.sd_s, statistics.u_mean_s);
  std::vector<double> sorted = deviations_s;
  std::sort(sorted.begin(), sorted.end());
  statistics.minimum_s = sorted.front();
  statistics.maximum_s = sorted.back();
  statistics.quantile_025_s = quantile_of_sorted(sorted, 0.025);
  statistics.quantile_975_s = quantile_of_sorted(sorted, 0.975);
  add_drift(statistics, deviations_s);
  statistics.allan = allan_of_max_stretch(raws);
  return statistics;
}

} // namespace dyncal::analysis
