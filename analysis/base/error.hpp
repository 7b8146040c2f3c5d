// Why an evaluation has no number to give. The library returns tl::expected<T, Error> and throws
// nothing.
#pragma once

#include "analysis/base/failure.hpp"

namespace dyncal::analysis {

enum class ErrorCode {
  too_few_samples,        // fewer samples than parameters, or a record too short for the model
  not_finite,             // NaN or infinity among the values
  stamps_not_increasing,  // a stamp not later than the one before
  no_excitation,          // no sine of the frequency in the window
  frequency_out_of_range, // not positive, or above what the sample rate can carry
  ill_conditioned,        // the parameters cannot be told apart in this record
  not_converged,          // an iteration did not settle
  out_of_calibration,     // a correction is asked for outside the range it was calibrated in
  invalid_argument        // sizes or settings that contradict each other
};

using Error = Failure<ErrorCode>;

template <class T>
using Expected = tl::expected<T, Error>;

} // namespace dyncal::analysis
