#include <set>

#include <fmt/core.h>

#include "analysis/base/frequency.hpp"
#include "analysis/interferometer/decimation_filter.hpp"
#include "services/checks/bench_check/checks.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

// A fit over less than a period has no phase, over less than three a poor one.
constexpr double min_periods = 1.0;
constexpr double few_periods = 3.0;

std::set<std::string> measuring_sources(const MethodSettings& method) {
  std::set<std::string> names{method.reference.source, method.sync_acs.source,
                              method.sync_dau.source};
  for (const ChannelName& channel : method.dut) {
    names.insert(channel.source);
  }
  return names;
}

void check_source(const BenchView& view, const SourceView& source, Findings& findings) {
  if (!(source.rate_hz > 0.0)) {
    const SourceSettings& settings = *view.bench.source(source.name);
    const bool may_state = settings.is<SmartupSourceSettings>() ||
                           settings.is<SocketSourceSettings>() || settings.is<CanSourceSettings>();
    if (may_state && !source.problem) {
      findings.push_back(view.at(
          Severity::note, {"sources", source.name},
          "does not state a sample rate, so its frequencies cannot be held against half of it; "
          "write nominal_rate_hz = 1000.0, or as the instrument is set"));
    }
    return;
  }
  const auto& frequencies = view.bench.excitation.frequencies_hz;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const auto frequency = analysis::Frequency::parse(frequencies[i]);
    if (frequency && frequency->hz() >= 0.5 * source.rate_hz) {
      findings.push_back(view.at(
          Severity::error, {"excitation", "frequencies_hz"},
          fmt::format("holds \"{}\", but source '{}' takes {:.6g} samples a second ({}), which "
                      "show frequencies below {:.6g} Hz only: take it out, or set the source to a "
                      "higher rate",
                      frequencies[i], source.name, source.rate_hz, source.rate_origin,
                      0.5 * source.rate_hz),
          i));
    }
  }
}

// The filter before a displacement of quadrature signals is flat up to a part of its rate.
void check_pass_band(const BenchView& view, Findings& findings) {
  const ChannelName& reference = view.bench.method.reference;
  const SourceSettings* settings = view.bench.source(reference.source);
  const SourceView* source = view.source(reference.source);
  if (settings == nullptr || source == nullptr || !settings->interferometer ||
      settings->interferometer->channel != reference.channel) {
    return;
  }
  const double rate_hz = source->rate_hz > 0.0
                             ? source->rate_hz
                             : settings->interferometer->output_rate_hz.value_or(0);
  const auto& frequencies = view.bench.excitation.frequencies_hz;
  for (std::size_t i = 0; i < frequencies.size() && rate_hz > 0.0; ++i) {
    const auto frequency = analysis::Frequency::parse(frequencies[i]);
    if (frequency && frequency->hz() > analysis::flat_pass_band * rate_hz) {
      findings.push_back(view.at(
          Severity::error, {"excitation", "frequencies_hz"},
          fmt::format("holds \"{}\", but {} is right up to {:.6g} Hz only at its {:.6g} samples a "
                      "second: take it out, or raise output_rate_hz of the interferometer",
                      frequencies[i], reference.text(), analysis::flat_pass_band * rate_hz,
                      rate_hz),
          i));
    }
  }
}

void check_duration(const BenchView& view, Findings& findings) {
  const ExcitationSettings& excitation = view.bench.excitation;
  if (excitation.whole_record || !(excitation.duration_s > 0.0)) {
    return;
  }
  for (std::size_t i = 0; i < excitation.frequencies_hz.size(); ++i) {
    const auto frequency = analysis::Frequency::parse(excitation.frequencies_hz[i]);
    const double periods = frequency ? frequency->hz() * excitation.duration_s : few_periods;
    if (periods >= few_periods) {
      continue;
    }
    const bool none = periods < min_periods;
    findings.push_back(view.at(
        none ? Severity::error : Severity::warning, {"excitation", "frequencies_hz"},
        fmt::format("holds \"{}\", of which duration_s = {:g} evaluates {:.2g} periods{}: at least "
                    "{:.3g} s give three",
                    excitation.frequencies_hz[i], excitation.duration_s, periods,
                    none ? ", less than one" : "", few_periods / frequency->hz()),
        i));
  }
}

} // namespace

Findings check_rates(const BenchView& view) {
  Findings findings;
  const std::set<std::string> measuring = measuring_sources(view.bench.method);
  for (const SourceView& source : view.sources) {
    if (measuring.contains(source.name)) {
      check_source(view, source, findings);
    }
  }
  check_pass_band(view, findings);
  check_duration(view, findings);
  return findings;
}

} // namespace dyncal::inline checks::bench_check
