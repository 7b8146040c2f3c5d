#include "analysis/uncertainty/common_contributions.hpp"

namespace dyncal::analysis {

bool is_common_to_results(ContributionKind kind) {
  switch (kind) {
  case ContributionKind::adc_phase:
  case ContributionKind::channel_delay:
  case ContributionKind::reference:
  case ContributionKind::trigger_delay:
  case ContributionKind::trace_clock:
  case ContributionKind::transverse_motion:
  case ContributionKind::wavelength:
  case ContributionKind::detector_bandwidth:
  case ContributionKind::detector_skew:
    return true;
  case ContributionKind::fit_noise:
  case ContributionKind::quantisation:
  case ContributionKind::rice:
  case ContributionKind::structure:
  case ContributionKind::stamp_jitter:
  case ContributionKind::stamp_tick:
  case ContributionKind::sync_jitter:
  case ContributionKind::record_frequency:
  case ContributionKind::clock_offset:
  case ContributionKind::apparent_frequency:
  case ContributionKind::series_start:
  case ContributionKind::shots:
  case ContributionKind::mains_hum:
  case ContributionKind::folded_harmonic:
  case ContributionKind::background:
  case ContributionKind::motion_frequency:
  case ContributionKind::interferometer_ellipse:
  case ContributionKind::periodic_error:
  case ContributionKind::simultaneity:
  case ContributionKind::other:
    break;
  }
  return false;
}

} // namespace dyncal::analysis
