#include "services/network/bounded_results.hpp"
#include "services/base/printable_text.hpp"

namespace dyncal::network {
namespace {

template <class List>
void shorten(List& list, std::size_t most) {
  if (list.size() > most) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(most), list.end());
  }
}

void bound(std::vector<Flag>& flags, const Limits& limits) {
  shorten(flags, limits.channels);
  for (Flag& flag : flags) {
    flag.sentence = one_line(flag.sentence);
  }
}

} // namespace

void bound(StepResult& result, const Limits& limits) {
  for (std::string* text : {&result.frequency_text_hz, &result.problem, &result.unit}) {
    *text = one_line(*text);
  }
  shorten(result.fits, limits.channels);
  shorten(result.budget, limits.channels);
  shorten(result.signals, limits.channels);
  shorten(result.samples, limits.channels);
  for (analysis::Contribution& row : result.budget) {
    row.subject = one_line(row.subject);
  }
  for (analysis::ChannelFit& fit : result.fits) {
    fit.channel = one_line(fit.channel);
  }
  bound(result.flags, limits);
}

void bound(TransferFunction& function, const Limits& limits) {
  shorten(function.points, limits.rows);
  for (FrequencyPoint& point : function.points) {
    point.frequency_text_hz = one_line(point.frequency_text_hz);
  }
  if (function.group_delay) {
    function.group_delay->phase_covariance = {}; // its square: nobody here needs it
  }
  function.unit = one_line(function.unit);
  function.group_delay_problem = one_line(function.group_delay_problem);
  shorten(function.closures, limits.channels);
  for (Closure& closure : function.closures) {
    for (std::string* text : {&closure.subject, &closure.unit, &closure.sentence}) {
      *text = one_line(*text);
    }
  }
  bound(function.flags, limits);
}

void bound(ClockReport& report, const Limits& limits) {
  analysis::SampleClockStatistics& clock = report.clock;
  shorten(clock.modes_s, limits.rows);
  shorten(clock.histogram, limits.rows);
  shorten(clock.over_time, limits.rows);
  shorten(clock.close_up_ns, limits.rows);
  shorten(clock.events, limits.rows);
  shorten(clock.over_temperature, limits.rows);
  shorten(clock.scatter_temperature_degc, limits.rows);
  shorten(clock.scatter_interval_ns, limits.rows);
  shorten(clock.allan, limits.rows);
  bound(report.flags, limits);
}

} // namespace dyncal::network
