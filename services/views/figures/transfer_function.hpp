// The complex transfer function as a picture: magnitude above, phase below, over frequency on a
// logarithmic axis, every repetition with a marker of its own, the mean as a line with error bars
// of u or U, and the low frequencies enlarged where the plot has room (figure 5 of the paper).
//
// Where a frequency was excited at several levels, every level has markers of its own and a line of
// its means, and the legend names it.
//
// Means with a flag have a ring around them, and sentences below the panels explain each flag.
// Points of repetitions carry their step.
//
// Its ticks are the frequencies measured. Without its delay, the phase is drawn as what the group
// delay leaves of it, near its intercept, so that bars can be seen; the caption says the delay.
//
// Phase is lead in radians (ISO 2041): a delay has negative phase and falls with frequency.
// Repetitions may be given in (-pi, pi]; they are drawn in the turn of the mean at the same
// frequency.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/response/group_delay.hpp"
#include "services/views/figures/figure.hpp"

namespace dyncal::inline views::figures {

enum class ErrorBars {
  standard, // u
  expanded, // U, for a coverage of 95.45 %
  none,
};
// "U"; of none it is empty.
[[nodiscard]] const char* symbol_of(ErrorBars bars);

struct ComplexValue { // with standard uncertainties
  double magnitude = 0.0;
  double u_magnitude = 0.0;
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
};

struct ValueOverFrequency {
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0; // as planned
  ComplexValue value{};
  std::string flags{}; // names, separated by spaces
  // U: of means; of repetitions only while there are plain means.
  double expanded_magnitude = 0.0;
  double expanded_phase_rad = 0.0;
  double stated_phase_rad = 0.0; // of means: in (-pi, pi], where the value's is continuous
};

struct RepetitionPoint {
  std::uint32_t repetition = 0;
  ValueOverFrequency point{};
  // What the fitted sine leaves of the channel, over its amplitude; NaN: not known.
  double residual_rel = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t step = 0;    // 0: not known
  std::uint32_t attempt = 1; // the excitation of the step
};

struct TransferFunctionData {
  std::string title{};        // e.g. "acc-1: dau/acceleration_z"
  std::string subtitle{};     // e.g. run and date; may be empty
  std::string unit{};         // of the magnitude; "1" for none, empty: not known
  std::string excited_axis{}; // empty: not stated
  std::vector<RepetitionPoint> repetitions{};
  std::vector<ValueOverFrequency> mean{}; // unwrapped phase
  std::optional<analysis::GroupDelay> group_delay{};
  Language language = Language::english;
  bool removes_delay = false; // from the phase that is drawn, where there is a group delay
  std::vector<std::string> flag_sentences{}; // below the panels
  ErrorBars error_bars = ErrorBars::standard;
  // The run lasts: the means are plain ones of what there is, without uncertainty, and the bars are
  // those of the repetitions.
  bool means_are_plain = false;
};

// Half the length of a value's error bar.
[[nodiscard]] double half_magnitude_bar(const ValueOverFrequency& value, ErrorBars bars);
[[nodiscard]] double half_phase_bar(const ValueOverFrequency& value, ErrorBars bars);

// All levels, ascending, if there is a frequency that has several; else empty.
[[nodiscard]] std::vector<double> told_levels(const TransferFunctionData& data);

// All frequencies, rising.
[[nodiscard]] std::vector<double> measured_frequencies(const TransferFunctionData& data);

// Markers of one colour: of a repetition, or of a level where those are told apart.
struct MarkerGroup {
  std::string label{}; // "#2 ± u", "10 m/s² ± u"; without bars "#2"
  std::size_t colour = 0;
  std::vector<Point> points{};
};
// `points`: of each of the data's repetitions, in their order; nothing: not shown.
[[nodiscard]] std::vector<MarkerGroup>
marker_groups(const TransferFunctionData& data, const std::vector<std::optional<Point>>& points,
              ErrorBars bars);

// The mean at the frequency and level of a repetition; null where there is none. Lives as long as
// the data.
[[nodiscard]] const ValueOverFrequency* mean_of(const ValueOverFrequency& repetition,
                                                const TransferFunctionData& data);

[[nodiscard]] Figure transfer_function_figure(const TransferFunctionData& data,
                                              const std::string& name);

} // namespace dyncal::inline views::figures
