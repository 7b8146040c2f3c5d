#include "services/views/live/run_json.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "services/views/report/flag_legend.hpp"
#include "services/views/report/json_number.hpp"
#include "services/views/report/step_json.hpp"

namespace dyncal::services::live {
namespace {

using Json = nlohmann::ordered_json;

Json fit_json(const analysis::ChannelFit& channel_fit) {
  const analysis::SineFit& fit = channel_fit.fit;
  const double samples = static_cast<double>(std::max<std::uint64_t>(fit.samples, 1));
  return {{"channel", channel_fit.channel},
          {"frequency_hz", json_number(channel_fit.frequency.hz())},
          {"u_frequency_hz", json_number(channel_fit.u_frequency_hz)},
          {"phase_origin_ns", std::to_string(channel_fit.phase_origin_ns)},
          {"sine", json_number(fit.sine)},
          {"cosine", json_number(fit.cosine)},
          {"offset", json_number(fit.offset)},
          {"u_sine", json_number(std::sqrt(fit.covariance[0]))},
          {"u_cosine", json_number(std::sqrt(fit.covariance[3]))},
          {"u_offset", json_number(std::sqrt(fit.covariance[5]))},
          {"residual_rms", json_number(std::sqrt(fit.rss / samples))},
          {"sample_count", fit.samples}};
}

// Those of the channel and of the valid results that the mean was made of, each once.
std::vector<Flag> flags_of(const Run& run, const TransferFunction& function,
                           const FrequencyPoint& point) {
  std::vector<Flag> flags;
  for (const auto& [key, result] : run.results) {
    if (result.valid && result.channel == function.channel &&
        result.frequency_hz == point.frequency_hz && result.level_m_s2 == point.level_m_s2) {
      flags.insert(flags.end(), result.flags.begin(), result.flags.end());
    }
  }
  flags.insert(flags.end(), function.flags.begin(), function.flags.end());
  return flags_once(flags);
}

Json transfer_json(const Run& run, const TransferFunction& function) {
  Json points = Json::array();
  double largest_k = 0.0;
  for (const FrequencyPoint& point : function.points) {
    largest_k =
        std::max({largest_k, magnitude_uncertainty(point.mean).k, phase_uncertainty(point.mean).k});
    points.push_back(mean_json(point));
    points.back()["flags"] = flags_json(flags_of(run, function, point));
  }
  Json json{{"channel", function.channel},
            {"unit", function.unit},
            {"lost", function.lost},
            {"advice", advice_on_repetitions(largest_k)},
            {"flags", flags_json(function.flags)},
            {"group_delay_s", nullptr},
            {"u_group_delay_s", nullptr},
            {"group_delay_problem", function.group_delay_problem}};
  if (function.group_delay) {
    json["group_delay_s"] = json_number(function.group_delay->delay_s);
    json["u_group_delay_s"] = json_number(function.group_delay->u_delay_s);
  }
  json["points"] = std::move(points);
  return json;
}

Json course_json(const analysis::SampleClockStatistics& clock) {
  Json course = Json::array();
  for (const analysis::IntervalBucket& bucket : clock.over_time) {
    course.push_back({{"time_s", json_number(bucket.time_s)},
                      {"min_interval_ns", json_number(bucket.minimum_ns)},
                      {"max_interval_ns", json_number(bucket.maximum_ns)},
                      {"mean_interval_ns", json_number(bucket.mean_ns)}});
  }
  return course;
}

Json histogram_json(const analysis::SampleClockStatistics& clock) {
  Json histogram = Json::array();
  for (const analysis::IntervalHistogramBin& bin : clock.histogram) {
    histogram.push_back({{"interval_ticks", std::to_string(bin.ticks)},
                         {"interval_ns", json_number(bin.interval_ns)},
                         {"interval_count", bin.count}});
  }
  return histogram;
}

Json clock_json(const ClockReport& report) {
  const analysis::SampleClockStatistics& clock = report.clock;
  Json events = Json::array();
  for (const analysis::IntervalEvent& event : clock.events) {
    events.push_back({{"kind", event.kind},
                      {"sample", std::to_string(event.sample)},
                      {"time_s", json_number(event.time_s)},
                      {"size_ns", json_number(event.size_ns)},
                      {"missing_samples", event.missing}});
  }
  return {{"source", report.source},
          {"interval_count", clock.intervals},
          {"mean_interval_s", json_number(clock.mean_interval_s)},
          {"u_mean_interval_s", json_number(clock.u_mean_interval_s)},
          {"sd_interval_s", json_number(clock.sd_s)},
          {"min_interval_s", json_number(clock.minimum_s)},
          {"median_interval_s", json_number(clock.median_s)},
          {"max_interval_s", json_number(clock.maximum_s)},
          {"nominal_rate_hz", json_number(clock.nominal_rate_hz)},
          {"mean_rate_hz", json_number(clock.mean_rate_hz)},
          {"tick_s", json_number(clock.tick_s)},
          {"event_count", clock.event_count},
          {"lost", clock.lost},
          {"flags", flags_json(report.flags)},
          {"histogram", histogram_json(clock)},
          {"over_time", course_json(clock)},
          {"events", std::move(events)}};
}

} // namespace

Json flags_json(const std::vector<Flag>& flags) {
  Json list = Json::array();
  for (const Flag& flag : flags) {
    list.push_back({{"name", name_of(flag.kind)},
                    {"text", flag.sentence},
                    {"meaning", explanation_of(flag.kind)}});
  }
  return list;
}

Json point_json(const StepResult& result) {
  Json fits = Json::array();
  for (const analysis::ChannelFit& fit : result.fits) {
    fits.push_back(fit_json(fit));
  }
  Json json = value_json(result);
  json.update({{"attempt", result.attempt},
               {"problem", result.problem},
               {"flags", flags_json(result.flags)},
               {"provisional", result.provisional},
               {"temperature_degc", nullptr},
               {"sample_rate_hz", nullptr},
               {"u_sample_rate_hz", nullptr},
               {"fits", std::move(fits)},
               {"signals", signals_json(result)}});
  if (result.temperature_degc) {
    json["temperature_degc"] = json_number(*result.temperature_degc);
  }
  if (result.valid) {
    add_expanded(magnitude_uncertainty(result), phase_uncertainty(result), json);
  }
  if (result.series) {
    json["sample_rate_hz"] = json_number(result.series->sample_rate_hz);
    json["u_sample_rate_hz"] = json_number(result.series->u_sample_rate_hz);
  }
  return json;
}

Json run_json(const Run& run) {
  Json json{{"run", run.name},
            {"state", to_string(run.state())},
            {"points", Json::array()},
            {"transfer", Json::array()},
            {"clock", Json::array()}};
  for (const auto& [key, result] : run.results) {
    json["points"].push_back(point_json(result));
  }
  for (const auto& [channel, function] : run.transfer_functions) {
    json["transfer"].push_back(transfer_json(run, function));
  }
  for (const auto& [source, report] : run.clock_reports) {
    json["clock"].push_back(clock_json(report));
  }
  return json;
}

} // namespace dyncal::services::live
