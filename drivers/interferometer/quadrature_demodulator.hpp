// From the running pair of quadrature signals to unwrapped phase, with NaN where there is none, and
// what is known of the interferometer as it is described to others.
//
//   NaN                    where
//   no ellipse yet         nothing is stated, and the signals have not shown one
//   not measured           u1 or u2 is no number
//   clipped                u1 or u2 is at an end of its range
//   without beam           the radius is below a fifth of the ellipse's
//   doubtful               the phase step is more than a quarter of a turn from the one expected:
//                          whole turns may be lost there
//
// Behind samples of all but the last kind nothing is expected of the phase. Counted are all but
// those without an ellipse. A slow detector loses radius where the fringes are fast: radius_ratio()
// is that of the signals so far, to be forgotten by whoever has looked.
//
// No synchronisation.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/interferometer/ellipse_moments.hpp"
#include "analysis/interferometer/quadrature_phase.hpp"
#include "drivers/interferometer/interferometer_settings.hpp"
#include "drivers/interferometer/running_ellipse.hpp"
#include "drivers/quadrature_signals.hpp"

namespace dyncal::drivers::interferometer {

// What the channels can carry; empty: not known.
struct PairRanges {
  std::optional<analysis::SignalRange> u1{};
  std::optional<analysis::SignalRange> u2{};
};

struct DemodulationCounts {
  std::uint64_t not_measured = 0;
  std::uint64_t clipped = 0;
  std::uint64_t without_beam = 0;
  std::uint64_t doubtful = 0;
};

class QuadratureDemodulator {
public:
  QuadratureDemodulator(const InterferometerSettings& settings, const PairRanges& ranges,
                        double rate_hz);

  // Appends the phase in turns. REQUIRES: as many samples of u1 as of u2.
  void push(std::span<const double> u1, std::span<const double> u2, std::vector<double>& turns);
  // The pairs that follow are of another time: nothing is expected of their phase.
  void begin_again();

  [[nodiscard]] const DemodulationCounts& counts() const { return counts_; }
  [[nodiscard]] bool has_ellipse() const { return phase_.has_value(); }
  [[nodiscard]] const std::string& problem() const { return running_.problem(); }
  // Smallest over largest radius; and largest over that of the ellipse.
  [[nodiscard]] std::optional<double> radius_ratio() const;
  [[nodiscard]] std::optional<double> radius_over_stated() const;
  void forget_radius();
  // As it is now; changes with the ellipse, and when the phase has gone round with it.
  [[nodiscard]] const QuadratureSignals& described() const { return described_; }

private:
  enum class Fault : std::uint8_t { none, not_measured, clipped, without_beam };

  void push_chunk(std::span<const double> u1, std::span<const double> u2, std::span<double> turns);
  void push_faulty(std::span<const double> u1, std::span<const double> u2, std::span<double> turns);
  [[nodiscard]] Fault fault_of(double u1, double u2) const;
  [[nodiscard]] bool reaches_end(const analysis::EllipseMoments& sums) const;
  void mark_doubtful(std::span<double> turns);
  void take(const FoundEllipse& found);
  void look_at_radius();

  QuadratureSignals described_;
  PairRanges ranges_;
  bool is_stated_;
  RunningEllipse running_;
  analysis::Ellipse ellipse_;
  std::optional<analysis::QuadraturePhase> phase_;
  std::uint64_t since_radius_ = 0; // samples since the harmonics were looked at
  bool radius_known_ = false;      // of this ellipse
  bool periodic_error_stated_ = false;
  double before_ = 0.0; // the last two unwrapped phases, NaN where there is none
  double last_ = 0.0;
  double min_radius_squared_;
  double max_radius_squared_;
  DemodulationCounts counts_;
};

} // namespace dyncal::drivers::interferometer
