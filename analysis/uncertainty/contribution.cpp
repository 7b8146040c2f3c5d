#include "analysis/uncertainty/contribution.hpp"

#include <array>

#include "analysis/uncertainty/contribution_identifier.hpp"

namespace dyncal::analysis {
namespace {

struct Row {
  ContributionKind kind;
  std::string_view identifier;
  std::string_view text;
  bool has_subject;
  Repeats repeats;
};

// In the order of the enumeration.
constexpr std::array rows{
    Row{ContributionKind::fit_noise, "fit_noise", "noise of", true, Repeats::anew},
    Row{ContributionKind::quantisation, "quantisation", "quantisation of", true, Repeats::common},
    Row{ContributionKind::rice, "rice", "magnitude of noise (Rice)", false, Repeats::common},
    Row{ContributionKind::structure, "structure", "structure in", true, Repeats::anew},
    Row{ContributionKind::stamp_jitter, "stamp_jitter", "jitter of", true, Repeats::anew},
    Row{ContributionKind::stamp_tick, "stamp_tick", "tick of", true, Repeats::anew},
    Row{ContributionKind::sync_jitter, "sync_jitter", "jitter of the DAU sync alone", false,
        Repeats::anew},
    Row{ContributionKind::adc_phase, "adc_phase", "phase of the DAU sync ADC", false,
        Repeats::common_delay},
    Row{ContributionKind::channel_delay, "channel_delay", "delay between", true,
        Repeats::common_delay},
    Row{ContributionKind::reference, "reference", "reference", true, Repeats::common},
    Row{ContributionKind::record_frequency, "record_frequency", "frequency between the records",
        false, Repeats::anew},
    Row{ContributionKind::clock_offset, "clock_offset", "offset between the clocks", false,
        Repeats::common_delay},
    Row{ContributionKind::apparent_frequency, "apparent_frequency",
        "apparent frequency, from the middle of the series to sample 0", false, Repeats::anew},
    Row{ContributionKind::trigger_delay, "trigger_delay", "trigger delay of the oscilloscope",
        false, Repeats::common_delay},
    Row{ContributionKind::series_start, "series_start", "start of the series after the trigger",
        false, Repeats::common_delay},
    Row{ContributionKind::shots, "shots", "shots: noise and scatter of series and trigger", false,
        Repeats::anew},
    Row{ContributionKind::trace_clock, "trace_clock", "clock of the oscilloscope", false,
        Repeats::common_delay},
    Row{ContributionKind::mains_hum, "mains_hum", "mains hum in", true, Repeats::anew},
    Row{ContributionKind::folded_harmonic, "folded_harmonic", "folded harmonics of", true,
        Repeats::common},
    Row{ContributionKind::background, "background", "background in", true, Repeats::anew},
    Row{ContributionKind::transverse_motion, "transverse_motion",
        "transverse motion of the exciter", false, Repeats::common},
    Row{ContributionKind::motion_frequency, "motion_frequency",
        "frequency between displacement, velocity and acceleration", false, Repeats::common},
    Row{ContributionKind::interferometer_ellipse, "interferometer_ellipse",
        "ellipse of the interferometer", false, Repeats::common},
    Row{ContributionKind::periodic_error, "periodic_error", "periodic error of the interferometer",
        false, Repeats::common},
    Row{ContributionKind::wavelength, "wavelength", "wavelength of the laser in air", false,
        Repeats::common},
    Row{ContributionKind::detector_bandwidth, "detector_bandwidth",
        "bandwidth of the interferometer's detectors", false, Repeats::common_delay},
    Row{ContributionKind::detector_skew, "detector_skew", "skew of the interferometer's detectors",
        false, Repeats::common_delay},
    Row{ContributionKind::simultaneity, "simultaneity", "simultaneity of sensor and reference",
        false, Repeats::anew},
    Row{ContributionKind::other, "other", "other", false, Repeats::common}};

constexpr bool in_order() {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].kind != static_cast<ContributionKind>(i)) {
      return false;
    }
  }
  return rows.size() == static_cast<std::size_t>(ContributionKind::other) + 1;
}
static_assert(in_order());

const Row& row_of(ContributionKind kind) {
  return rows[static_cast<std::size_t>(kind)];
}

} // namespace

std::string_view to_string(ContributionKind kind) {
  return row_of(kind).text;
}

std::string_view identifier_of(ContributionKind kind) {
  return row_of(kind).identifier;
}

std::string_view to_string(Repeats repeats) {
  switch (repeats) {
  case Repeats::anew:
    return "anew";
  case Repeats::common:
    return "common";
  case Repeats::common_delay:
    return "common delay";
  }
  return "unknown";
}

Repeats repeats_of(ContributionKind kind) {
  return row_of(kind).repeats;
}

std::string Contribution::name() const {
  if (kind == ContributionKind::other) {
    return subject;
  }
  const std::string text(to_string(kind));
  return subject.empty() ? text : text + " " + subject;
}

NamedKind parse_contribution_name(std::string_view name) {
  for (const Row& row : rows) { // whole names first: "jitter of the DAU sync alone"
    const bool stands_alone = !row.has_subject || row.kind == ContributionKind::reference;
    if (stands_alone && row.kind != ContributionKind::other && name == row.text) {
      return {row.kind, {}};
    }
  }
  for (const Row& row : rows) {
    if (row.has_subject && name.size() > row.text.size() + 1 && name.starts_with(row.text) &&
        name[row.text.size()] == ' ') {
      return {row.kind, std::string(name.substr(row.text.size() + 1))};
    }
  }
  return {ContributionKind::other, std::string(name)};
}

} // namespace dyncal::analysis
