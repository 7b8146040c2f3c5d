// A quadrature interferometer on the table of the virtual bench, and the digitiser that records its
// two signals beside sync.
//
//   u1 = p + R cos(phi) + n1
//   u2 = q + (R / r) sin(phi - alpha) + n2      phi = 4 pi N s / lambda + phi_0
//
// s is the displacement of the table (excitation.hpp, table_drift.hpp) towards growing phase, N the
// number of passes. R is 0.64 of the digitiser's range of 1 V, n has 2e-3 R. Drawn from the seed,
// with either sign and 0.5 to 1.5 times: offsets p, q of 3 % of R, r off by 5 %, alpha of 5
// degrees. Drawn from what the bench file states: lambda from its standard uncertainty, the delay
// of both photodiodes between 0 and 1 / (2 pi bandwidth), that of u2 after u1 from `u_skew_s`.
//
// Values are counts of 14 bits, all three channels sampled at once. A detector's bandwidth takes
// nothing off the radius. One thread.
#pragma once

#include <complex>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/virtual_bench/model/normal_table.hpp"
#include "drivers/virtual_bench/model/random.hpp"
#include "drivers/virtual_bench/model/sampled_motion.hpp"
#include "drivers/virtual_bench/model/table_drift.hpp"

namespace dyncal::drivers::virtual_bench {

struct InterferometerSettings {
  double wavelength_m = 632.82e-9; // in air
  double u_wavelength_rel = 5e-6;  // standard uncertainty, as that of the skew
  int passes = 1;
  double detector_bandwidth_hz = 20e6;
  double u_skew_s = 1e-9;
  std::complex<double> spot{1.0, 0.0}; // motion where the laser looks, over that of the sensor
};

struct AcsChannel {
  std::string name;
  std::string quantity; // as the description line says it
  std::string unit;
  double range = 0.0; // +-, in the unit
  double scale = 0.0; // unit per count
};

struct InterferometerTruth {
  double p_v = 0.0;
  double q_v = 0.0;
  double radius_v = 0.0;
  double r = 1.0;
  double alpha_rad = 0.0;
  double wavelength_m = 0.0;
  double phase_0_rad = 0.0;
  double detector_delay_s = 0.0;
  double skew_s = 0.0; // of u2 after u1
};

class Interferometer {
public:
  // `interval_s`: of the digitiser, in bench time.
  Interferometer(const InterferometerSettings& settings, std::uint64_t seed, double interval_s,
                 const SyncLevel& sync);

  // Appends counts of the samples `from` to `to` (exclusive): u1, u2, sync, u1, u2, sync, ...
  // REQUIRES: `from` is the `to` of the call before, 0 at first.
  void sample(std::uint64_t from, std::uint64_t to, const Excitation& excitation,
              std::vector<std::int32_t>& counts);

  [[nodiscard]] static std::vector<AcsChannel> channels();
  [[nodiscard]] const InterferometerTruth& truth() const { return truth_; }
  [[nodiscard]] const TableDrift& drift() const { return drift_; }

private:
  void digitise(std::size_t from, std::size_t to, std::int32_t* counts);

  InterferometerTruth truth_;
  TableDrift drift_;
  SampledMotion motion_;
  Random noise_;
  NormalTable normal_;
  double interval_s_;
  double turns_per_m_;
  double last_turns_ = 0.0;
  SampledMotion::Block displacement_m_{};
  SampledMotion::Block sync_v_{};
};

} // namespace dyncal::drivers::virtual_bench
