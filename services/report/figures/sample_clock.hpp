// The sample clock of a sensor as pictures: how its sample intervals are distributed, and how they
// go with temperature and time (figures 6 to 9 of the paper).
//
// Data are in the units of the SampleClockReport; the pictures show intervals in microseconds. An
// interval that differs from the median by more than half of it is not the clock's doing but a lost
// or doubled sample: it stays in the CSV, and the picture says how many there are instead of
// shrinking everything else.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/report/figures/figure.hpp"

namespace dyncal::services::figures {

struct IntervalCount {
  std::int64_t interval_ticks;
  double interval_ns;
  std::uint64_t count;
};

struct IntervalHistogramData {
  std::string title{};
  double tick_s = 0; // of the counter that made the time stamps; 0: not known
  double mean_interval_s = 0;
  double sd_s = 0;
  double minimum_s = 0;
  double maximum_s = 0;
  std::vector<IntervalCount>
      counts{}; // one a tick, in any order; ticks that did not occur may be missing
};

struct TemperatureBin {
  double temperature_degc;
  double mean_interval_ns;
  double sd_interval_ns;
  std::uint64_t count;
};

struct IntervalOverTemperatureData {
  std::string title{};
  std::string subtitle{};                 // may be empty
  std::vector<double> temperature_degc{}; // of single intervals
  std::vector<double> interval_ns{};      // as many
  std::vector<TemperatureBin> bins{};
};

struct IntervalBucket {
  double time_s;
  double minimum_ns;
  double maximum_ns;
  double mean_ns;
};

struct IntervalOverTimeData {
  std::string title{};
  std::string subtitle{}; // may be empty
  std::vector<IntervalBucket> overview{};
  double close_up_first_time_s = 0;
  std::vector<double> close_up_ns{}; // consecutive intervals
};

// Counts on a logarithmic axis; a bin is a whole number of ticks, so that the lattice of the stamps
// makes no comb.
[[nodiscard]] Figure interval_histogram_figure(const IntervalHistogramData& data,
                                               const std::string& name);

// Single intervals as dots, and mean and standard deviation for each bin of temperature.
[[nodiscard]] Figure interval_over_temperature_figure(const IntervalOverTemperatureData& data,
                                                      const std::string& name);

// The whole run above, smallest to largest interval of every stretch; consecutive intervals around
// one event below.
[[nodiscard]] Figure interval_over_time_figure(const IntervalOverTimeData& data,
                                               const std::string& name);

} // namespace dyncal::services::figures
