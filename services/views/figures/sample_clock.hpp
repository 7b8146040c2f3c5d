// The sample clock of a sensor as pictures: how its sample intervals are distributed, and how they
// go with temperature and time (figures 6 to 9 of the paper).
//
// The CSV files have the units of the statistics (analysis/clock/sample_clock.hpp); the pictures
// show intervals in microseconds. An interval that differs from the median by more than half of it
// was not made by the clock but by a lost or doubled sample: it stays in the CSV, and the picture
// gives their number instead of shrinking everything else.
#pragma once

#include <string>

#include "analysis/clock/sample_clock.hpp"
#include "services/views/figures/figure.hpp"

namespace dyncal::inline views::figures {

// Counts on a logarithmic axis; a bin is a whole number of ticks, so that the lattice of the stamps
// makes no comb. The subtitle is that of the numbers.
[[nodiscard]] Figure interval_histogram_figure(const PictureTitle& title,
                                               const analysis::SampleClockStatistics& clock,
                                               const std::string& name);

// Single intervals as dots, and mean and standard deviation for each bin of temperature.
[[nodiscard]] Figure interval_over_temperature_figure(const PictureTitle& title,
                                                      const analysis::SampleClockStatistics& clock,
                                                      const std::string& name);

// The whole run above, smallest to largest interval of every bucket; consecutive intervals around
// one event below.
[[nodiscard]] Figure interval_over_time_figure(const PictureTitle& title,
                                               const analysis::SampleClockStatistics& clock,
                                               const std::string& name);

} // namespace dyncal::inline views::figures
