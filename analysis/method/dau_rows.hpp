// Rows of what a DAU adds to a value, whatever the reference is: noise and jitter of its sync, the
// phase of its ADC, and the noise of the stamps that sync and the sensor have in common.
//
// Standard uncertainties, magnitude relative, phase in radians (sample_stamping.hpp). Any thread.
#pragma once

#include "analysis/clock/stamp_beat.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/sample_stamping.hpp"

namespace dyncal::analysis {

[[nodiscard]] double common_jitter_s(const SystematicUncertainty& systematic);

// Noise and quantisation of its sync.
void add_dau_sync_noise(Budget& budget, const RecordedChannel& sync_dau,
                        const SystematicUncertainty& systematic);

// The instants at which its ADC samples sync, and the phase of that ADC.
void add_dau_adc_rows(Budget& budget, const SampleStampingInput& input,
                      const RecordedChannel& sync_dau);

// Stamp noise common to sync and the sensor: the phase of the ratio sees it only as far as the two
// sines differ in phase.
void add_dau_stamp_noise(Budget& budget, const SampleStampingInput& input,
                         const RecordedChannel& dut, const RecordedChannel& sync_dau,
                         const StampBeat& beat);

} // namespace dyncal::analysis
