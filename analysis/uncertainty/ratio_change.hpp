// That the ratio of two sines is another one in the second part of their records. What finds it is
// ratio_blocks.hpp; results carry it. Plain data, any thread.
#pragma once

namespace dyncal::analysis {

struct RatioChange { // after less before
  double at_s = 0.0; // after the first stamp of the numerator
  double magnitude_rel = 0.0;
  double phase_rad = 0.0;
};

} // namespace dyncal::analysis
