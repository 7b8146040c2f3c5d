#include "services/programs/demo/truth_check.hpp"

#include <cmath>
#include <fstream>
#include <numbers>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace dyncal::inline programs {
namespace {

struct TruePoint {
  std::string channel; // without its source
  std::string frequency_text_hz;
  double magnitude;
  double phase_rad;
};

struct Truth {
  std::vector<TruePoint> points;
  double mean_interval_s; // NaN: not stated
};

Error unreadable(const std::filesystem::path& path, const std::string& why) {
  return {ErrorCode::bad_file,
          fmt::format("{}: the truth of the virtual bench cannot be read: {}", path.string(), why)};
}

Expected<Truth> read_truth(const std::filesystem::path& path) {
  std::ifstream stream(path);
  try {
    std::vector<TruePoint> points;
    const nlohmann::json truth = nlohmann::json::parse(stream);
    for (const auto& point : truth.at("transfer_function")) {
      points.push_back({point.at("channel"), point.at("frequency_text_hz"), point.at("magnitude"),
                        point.at("phase_rad")});
    }
    const double mean_interval_s = truth.contains("sample_clock")
                                       ? truth["sample_clock"].at("mean_interval_s").get<double>()
                                       : std::nan("");
    return Truth{std::move(points), mean_interval_s};
  } catch (const nlohmann::json::exception& error) {
    return fail(unreadable(path, error.what()));
  }
}

const FrequencyPoint* measured_point(const RunOutcome& outcome, const TruePoint& truth,
                                     std::string& channel) {
  for (const TransferFunction& function : outcome.transfer_functions) {
    channel = function.channel;
    if (channel.substr(channel.find('/') + 1) != truth.channel) {
      continue;
    }
    for (const FrequencyPoint& point : function.points) {
      if (point.frequency_text_hz == truth.frequency_text_hz) {
        return &point;
      }
    }
  }
  return nullptr;
}

void compare(TruthCheck& check, double deviation, double u, const std::string& where) {
  const double ratio = std::abs(deviation) / u;
  ++check.points;
  if (!(ratio <= check.worst)) { // NaN counts as worst
    check.worst = ratio;
    check.worst_where = where;
  }
}

} // namespace

Expected<TruthCheck> check_truth(const RunOutcome& outcome,
                                 const std::filesystem::path& truth_file) {
  DYNCAL_TRY(const auto truth, read_truth(truth_file));
  TruthCheck check;
  for (const TruePoint& point : truth.points) {
    std::string channel;
    const FrequencyPoint* measured = measured_point(outcome, point, channel);
    if (measured == nullptr) {
      if (outcome.interrupted) {
        continue; // not every frequency was reached
      }
      return fail(ErrorCode::no_result, fmt::format("the run has no result for {} at {} Hz",
                                                    point.channel, point.frequency_text_hz));
    }
    const double phase_rad =
        std::remainder(measured->mean.phase_rad - point.phase_rad, 2.0 * std::numbers::pi);
    compare(check, measured->mean.magnitude - point.magnitude, measured->mean.u_magnitude,
            fmt::format("{}, {} Hz, magnitude", channel, point.frequency_text_hz));
    compare(check, phase_rad, measured->mean.u_phase_rad,
            fmt::format("{}, {} Hz, phase", channel, point.frequency_text_hz));
  }
  for (const ClockReport& report : outcome.clock_reports) {
    if (report.clock.intervals ==
        0) { // found from series: a constant rate, with nothing but its uncertainty to differ by
      compare(check, report.clock.mean_interval_s - truth.mean_interval_s,
              report.clock.u_mean_interval_s, fmt::format("{}, sample interval", report.source));
    }
  }
  return check;
}

} // namespace dyncal::inline programs
