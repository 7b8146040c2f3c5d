// How regularly a sensor samples: analysis/clock/.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "analysis/clock/sample_clock.hpp"
#include "arrays.hpp"
#include "bindings.hpp"

namespace dyncal::python {
namespace {

using namespace nb::literals;
using analysis::AllanPoint;
using analysis::IntervalEvent;
using analysis::IntervalHistogramBin;
using analysis::SampleClock;
using analysis::SampleClockStatistics;
using analysis::TemperatureBin;

void push(SampleClock& clock, std::uint64_t first_sample, Array<std::int64_t>& stamps_ns,
          std::optional<Array<std::uint8_t>> flags, std::optional<Array<double>> temperature_degc) {
  const auto stamps = stamps_ns.span("stamps_ns");
  const auto flagged = flags ? flags->span("flags") : std::span<const std::uint8_t>{};
  const auto temperature =
      temperature_degc ? temperature_degc->span("temperature_degc") : std::span<const double>{};
  if ((flags && flagged.size() != stamps.size()) ||
      (temperature_degc && temperature.size() != stamps.size())) {
    refuse("flags and temperature_degc must be as long as stamps_ns");
  }
  clock.push(first_sample, stamps, flagged, temperature);
}

void bind_parts(nb::module_& module) {
  nb::class_<IntervalHistogramBin>(
      module, "IntervalHistogramBin",
      "How often an interval occurred, in ns. Source: analysis/clock/interval_histogram.hpp")
      .def_ro("ticks", &IntervalHistogramBin::ticks, "or bins, where the tick is not known")
      .def_ro("interval_ns", &IntervalHistogramBin::interval_ns)
      .def_ro("count", &IntervalHistogramBin::count);
  nb::class_<IntervalEvent>(
      module, "IntervalEvent",
      "An interval that is not a plain one. Source: analysis/clock/interval_events.hpp")
      .def_ro("kind", &IntervalEvent::kind, "'backward', 'duplicate', 'gap', 'pair', 'step'")
      .def_ro("sample", &IntervalEvent::sample, "number of the sample that begins the interval")
      .def_ro("time_s", &IntervalEvent::time_s, "since the first sample")
      .def_ro("size_ns", &IntervalEvent::size_ns, "deviation from the median")
      .def_ro("missing", &IntervalEvent::missing, "samples");
  nb::class_<TemperatureBin>(module, "TemperatureBin",
                             "Intervals at a temperature, in ns and degC.\n"
                             "Source: analysis/clock/temperature_relation.hpp")
      .def_ro("temperature_degc", &TemperatureBin::temperature_degc, "centre")
      .def_ro("mean_interval_ns", &TemperatureBin::mean_interval_ns)
      .def_ro("sd_interval_ns", &TemperatureBin::sd_interval_ns)
      .def_ro("count", &TemperatureBin::count);
  nb::class_<AllanPoint>(module, "AllanPoint",
                         "Allan deviation of the intervals, relative, at an averaging time in s.\n"
                         "Source: NIST SP 1065, 5.2.4; analysis/clock/allan_deviation.hpp")
      .def_ro("tau_s", &AllanPoint::tau_s)
      .def_ro("deviation", &AllanPoint::deviation, "relative");
}

void bind_statistics(nb::module_& module) {
  using S = SampleClockStatistics;
  nb::class_<S>(module, "SampleClockStatistics",
                "Of intervals between neighbouring samples.\n"
                "Source: analysis/clock/sample_clock.hpp")
      .def_ro("intervals", &S::intervals)
      .def_ro("mean_interval_s", &S::mean_interval_s)
      .def_ro("u_mean_interval_s", &S::u_mean_interval_s, "NaN: nothing is known of it")
      .def_prop_ro("of_mean_interval", &S::of_mean_interval)
      .def_ro("left_out_jumps", &S::left_out_jumps, "of the clock, which the mean leaves out")
      .def_ro("largest_jump_s", &S::largest_jump_s)
      .def_ro("sd_s", &S::sd_s)
      .def_ro("minimum_s", &S::minimum_s)
      .def_ro("maximum_s", &S::maximum_s)
      .def_ro("median_s", &S::median_s)
      .def_ro("mad_sd_s", &S::mad_sd_s, "1.4826 MAD")
      .def_ro("quantile_001_s", &S::quantile_001_s, "0.1 %")
      .def_ro("quantile_01_s", &S::quantile_01_s, "1 %")
      .def_ro("quantile_99_s", &S::quantile_99_s, "99 %")
      .def_ro("quantile_999_s", &S::quantile_999_s, "99.9 %")
      .def_ro("core_mean_s", &S::core_mean_s, "without events")
      .def_ro("core_sd_s", &S::core_sd_s, "without events")
      .def_ro("mean_rate_hz", &S::mean_rate_hz)
      .def_prop_ro("of_mean_rate", &S::of_mean_rate)
      .def_prop_ro("rate_deviation_rel", &S::rate_deviation_rel, "NaN: no rate is nominal")
      .def_prop_ro("of_rate_deviation", &S::of_rate_deviation)
      .def_ro("tick_s", &S::tick_s)
      .def_ro("lattice_statistic", &S::lattice_statistic, "1: whole ticks")
      .def_ro("modes_s", &S::modes_s)
      .def_ro("histogram", &S::histogram, "bins that are not empty, rising")
      .def_ro("events", &S::events, "the first of them")
      .def_ro("event_count", &S::event_count, "all of them")
      .def_ro("pair_count", &S::pair_count)
      .def_ro("pair_period_s", &S::pair_period_s)
      .def_ro("over_temperature", &S::over_temperature)
      .def_ro("temperature_correlation", &S::temperature_correlation)
      .def_ro("temperature_slope_s_per_degc", &S::temperature_slope_s_per_degc)
      .def_ro("allan", &S::allan)
      .def_ro("lost", &S::lost, "samples missing from the numbers, or by the stamps alone")
      .def_ro("untrusted", &S::untrusted, "samples whose stamp was flagged");
}

} // namespace

void bind_clocks(nb::module_& module) {
  bind_parts(module);
  bind_statistics(module);
  nb::class_<SampleClock>(module, "SampleClock",
                          "The sample clock of a sensor from the stamps of its samples.\n"
                          "\n"
                          "Memory is bounded; the statistics do not depend on how the stream was\n"
                          "divided into blocks. Of one thread.\n"
                          "Source: paper 3 and 4.2; analysis/clock/sample_clock.hpp")
      .def(
          "__init__",
          [](SampleClock* self, double nominal_rate_hz, double tick_s, double stamp_uncertainty_s) {
            analysis::SampleClockSettings settings;
            settings.nominal_rate_hz = nominal_rate_hz;
            settings.tick_s = tick_s;
            settings.stamp_uncertainty_s = stamp_uncertainty_s;
            new (self) SampleClock(settings);
          },
          nb::kw_only(), "nominal_rate_hz"_a = 0.0, "tick_s"_a = 0.0, "stamp_uncertainty_s"_a = 0.0,
          "tick_s: of the counter that stamps; 0: not known, as with the others.")
      .def("push", &push, "first_sample"_a, "stamps_ns"_a, "flags"_a = nb::none(),
           "temperature_degc"_a = nb::none(),
           "The next samples; a number that does not follow on is a loss, or a restart.\n"
           "\n"
           "stamps_ns: int64 (n,); flags: uint8 (n,), not 0: stamp not trusted;\n"
           "temperature_degc: float64 (n,). Raises Error (invalid_argument).")
      .def("statistics", &SampleClock::statistics, "None with fewer than two intervals.");
}

} // namespace dyncal::python
