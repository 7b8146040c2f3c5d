// The largest transverse sensitivity of one axis of a sensor over all directions across it, and the
// direction (ISO 16063-31): from its answers a and b to motions along the two other axes,
//
//   S(t)   = |a cos t + b sin t|                     to motion at the angle t from the first
//   S^2    = (|a|^2 + |b|^2) / 2 + sqrt((|a|^2 - |b|^2)^2 / 4 + Re(a b*)^2)      the largest
//   2 t    = atan2(2 Re(a b*), |a|^2 - |b|^2)
//   u^2(S) = cos^2 t u^2(a) + sin^2 t u^2(b)         u of each real component
//
// both over the answer to motion along the axis itself. A sensor whose phases differ has a largest
// one as well: S(t) is then the major half axis of an ellipse. Plain function; any thread.
#pragma once

#include <complex>

namespace dyncal::analysis {

struct TransverseAnswer {
  std::complex<double> h; // of the axis, to motion along another one
  double u = 0.0;         // of each real component
};

struct LargestTransverse {
  double ratio = 0.0; // to the answer along the axis
  double u_ratio = 0.0;
  double angle_rad = 0.0; // from the first axis towards the second, within [0, pi)
};

// `along`: the magnitude of the axis's answer to motion along itself, above 0.
[[nodiscard]] LargestTransverse largest_transverse(const TransverseAnswer& first,
                                                   const TransverseAnswer& second, double along);

} // namespace dyncal::analysis
