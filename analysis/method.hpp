// The library's door for who calibrates: <dyncal/method.hpp>. The recorded channels of a step in,
// one value of the complex transfer function with its uncertainty budget out.
//
//   H = P_sensor / P_reference = |H| e^{i psi}           psi is lead: a delay is negative
//
// 1. One of the paper's ways, by what links the clocks of sensor and reference:
//    evaluate_sample_stamping()   both record sync, the sensor's samples have stamps
//    evaluate_table_stamping()    the same, where the reference is a table of phasors
//    evaluate_series_stamping()   the sensor records series after a trigger, an oscilloscope sync
//    evaluate_absolute_time()     both clocks follow UTC
//    evaluate_analogue()          sensor and reference are channels of one clock
// 2. What is known of the instruments goes in: adc_calibration.hpp, reference_calibration.hpp,
//    trigger_delay.hpp.
// 3. means_of_repetitions() makes one value a frequency; budget.hpp and coverage.hpp give U and k;
//    check_transfer() holds them against a Monte Carlo calculation.
//
// Units stand in names. Functions return Expected and throw nothing. Any thread.
#pragma once

#include "analysis/base/error.hpp"
#include "analysis/base/frequency.hpp"
#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/instrument/reference_calibration.hpp"
#include "analysis/instrument/trigger_delay.hpp"
#include "analysis/method/analogue_comparison.hpp"
#include "analysis/method/repetitions.hpp"
#include "analysis/method/sample_stamping.hpp"
#include "analysis/method/series_stamping.hpp"
#include "analysis/method/table_stamping.hpp"
#include "analysis/method/transfer_check.hpp"
#include "analysis/method/transfer_point.hpp"
#include "analysis/uncertainty/budget.hpp"
#include "analysis/uncertainty/coverage.hpp"
