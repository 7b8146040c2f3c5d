// The four ways to link a sensor with digital output to the reference transducer, as bench file,
// recipe and contract name them.
//
// Plain functions, any thread.
#pragma once

#include "services/base/per_enumerator.hpp"

namespace dyncal::inline contract {

enum class EvaluationMethod {
  analogue,            // sensor and reference are channels of one system
  sample_timestamping, // every sample of the sensor has a stamp; sync links the two clocks
  series_timestamping, // the sensor records a series after a trigger, an oscilloscope records sync
  absolute_time        // sensor and reference are both stamped in UTC
};

// As the bench file and result files spell it: "sample-timestamping".
[[nodiscard]] constexpr const char* to_string(EvaluationMethod method) {
  return per_enumerator(
      method, {"analogue", "sample-timestamping", "series-timestamping", "absolute-time"});
}

// The steps are found in what the reference's own source records; no other source records sync.
[[nodiscard]] constexpr bool is_without_sync(EvaluationMethod method) {
  return method == EvaluationMethod::analogue || method == EvaluationMethod::absolute_time;
}

} // namespace dyncal::inline contract
