#include "services/instruments/shot_device.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "services/base/device_error.hpp"

namespace dyncal::inline instruments {
namespace {

using std::chrono::milliseconds;

constexpr double periods = 2.0;
constexpr std::size_t points = 10'000;
constexpr milliseconds min_trigger_limit{3000};
constexpr milliseconds series_limit{10'000}; // from the trigger to the end of the series

drivers::dso::OscilloscopeSettings oscilloscope_settings(const OscilloscopeSourceSettings& source) {
  drivers::dso::OscilloscopeSettings settings;
  settings.address = source.address;
  settings.family = source.family;
  settings.inputs.push_back({"sync", source.sync_input, source.sync_range_v, 0.0});
  settings.trigger_level_v = source.trigger_level_v;
  return settings;
}

} // namespace

drivers::dso::Acquisition acquisition_for(double frequency_hz) {
  const double half_s = 0.5 * periods / frequency_hz;
  return {.before_trigger_s = half_s, .after_trigger_s = half_s, .points = points};
}

ShotDevice::ShotDevice(const OscilloscopeSourceSettings& oscilloscope,
                       const SeriesSourceSettings& sensor, const drivers::StopSignal& stop)
    : oscilloscope_(oscilloscope_settings(oscilloscope), stop),
      sensor_(sensor.path.empty() ? drivers::tss::series_from_socket(sensor.address, stop)
                                  : drivers::tss::series_from_folder(sensor.path, stop)) {}

Expected<void> ShotDevice::connect(double frequency_hz) {
  return oscilloscope_.prepare(acquisition_for(frequency_hz))
      .and_then([&] { return sensor_->discard_pending(); })
      .map_error(device_error);
}

Expected<std::optional<ShotPair>> ShotDevice::take(double frequency_hz) {
  DYNCAL_TRY(connect(frequency_hz));
  const milliseconds trigger_limit =
      min_trigger_limit + milliseconds(static_cast<int>(3000.0 / frequency_hz));
  auto trace = oscilloscope_.acquire(trigger_limit);
  if (!trace) {
    triggers_.trigger_may_have_come();
    return fail(device_error(trace.error()));
  }
  triggers_.trigger_came();
  DYNCAL_TRY(auto series, series_of_last_trigger());
  if (!series) {
    return std::nullopt;
  }
  return ShotPair{std::move(*trace), std::move(*series)};
}

Expected<std::optional<drivers::tss::Series>> ShotDevice::series_of_last_trigger() {
  const auto before = triggers_.last();
  const auto deadline = std::chrono::steady_clock::now() + series_limit;
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now());
    auto series = sensor_->next(std::max(left, milliseconds(0)));
    if (!series) {
      return fail(device_error(series.error()));
    }
    switch (triggers_.judge(series->shot)) {
    case SeriesVerdict::belongs:
      return std::move(*series);
    case SeriesVerdict::late:
      break; // the right one is still to come
    case SeriesVerdict::first:
      return std::nullopt;
    case SeriesVerdict::open:
      return fail(
          ErrorCode::device,
          fmt::format("the sensor counts trigger {} after {}: which of them its series belongs "
                      "to is open; this shot is left out",
                      series->shot, before.value_or(0)));
    }
  }
}

} // namespace dyncal::inline instruments
