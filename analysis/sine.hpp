// The library's door for who fits sines: <dyncal/sine.hpp>. Stamped samples in, amplitude, phase,
// offset and frequency with their covariance out.
//
//   y(t) = A sin(w t) + B cos(w t) + C,   P = A + iB     phase is lead: a delay is negative
//
// 1. Frequency (frequency.hpp) is exact: "199.87" is no double. estimate_frequency() finds a start
//    value where nothing is known of it.
// 2. fit_sine() (sine_fit.hpp) fits all channels of one clock, the frequency given or refined.
// 3. The fits of disturbances.hpp do so beside drift, harmonics and hum, where they are
//    significant; unresolved_lines.hpp bounds what cannot be told from the sine.
// 4. What scatter of the stamps takes off an amplitude: stamp_scatter.hpp. How a sine moves along
//    its record: phasor_blocks.hpp.
//
// Units stand in names. Functions return Expected and throw nothing. Any thread.
#pragma once

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/base/phasor.hpp"
#include "analysis/sine/disturbances.hpp"
#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/frequency_estimate.hpp"
#include "analysis/sine/phasor_blocks.hpp"
#include "analysis/sine/sine_fit.hpp"
#include "analysis/sine/sine_values.hpp"
#include "analysis/sine/stamp_scatter.hpp"
#include "analysis/sine/unresolved_lines.hpp"
