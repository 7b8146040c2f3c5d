// Which ellipse the signals of an interferometer lie on, while they run: which one to begin with,
// and when a better one is there.
//
//   1. Without an ellipse the pairs of the last second are kept, and tried when they have become
//      twice as many, then four times a second (analysis/interferometer/record_ellipse.hpp).
//   2. With one, only the sums of the last second are kept, in parts of 50 ms, with the turns of
//      phase in them. Four times a second their ellipse is fitted: by linear least squares from a
//      turn on, adjusted from 0.35 turns.
//   3. It is better where it is the first one of a whole turn, or where its errors are half of
//      those of the ellipse in use; these grow by themselves, to the double in 30 s, so that
//      optics and detectors may drift. A step with a short arc thus keeps the ellipse of a longer.
//
// The errors that are stated of an ellipse include by how much it differs from the one before, so
// that a step during which it was adopted is covered. Samples without phase belong to no ellipse:
// reset_window() behind them.
//
// No synchronisation.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "analysis/interferometer/ellipse_moments.hpp"
#include "analysis/interferometer/interferometer_budget.hpp"
#include "analysis/interferometer/quadrature_phase.hpp"
#include "analysis/interferometer/record_ellipse.hpp"

namespace dyncal::drivers::interferometer {

struct FoundEllipse {
  analysis::Ellipse ellipse;
  analysis::EllipseErrors errors_rad{};              // standard uncertainties
  std::optional<analysis::RadiusHarmonics> radius{}; // where the record shows them
  analysis::EllipseMethod method = analysis::EllipseMethod::linear;
  double turns_covered = 0.0;
};

class RunningEllipse {
public:
  explicit RunningEllipse(double rate_hz);

  // The next pairs; `turns`: of their phase by the ellipse in use. Returns one to use from now on.
  // REQUIRES: as many samples of u1 as of u2; `sums` is of them.
  [[nodiscard]] std::optional<FoundEllipse> add(std::span<const double> u1,
                                                std::span<const double> u2,
                                                const analysis::EllipseMoments& sums,
                                                const analysis::PhaseStatistics& turns);
  void reset_window();

  // Why there is none yet; empty before anything was tried.
  [[nodiscard]] const std::string& problem() const { return problem_; }

private:
  struct Part {
    analysis::EllipseMoments sums;
    double min_turns = 0.0;
    double max_turns = 0.0;
  };

  [[nodiscard]] std::optional<FoundEllipse> first_ellipse(std::span<const double> u1,
                                                          std::span<const double> u2);
  [[nodiscard]] std::optional<FoundEllipse> better_ellipse();
  void add_to_parts(const analysis::EllipseMoments& sums, const analysis::PhaseStatistics& turns);

  double rate_hz_;
  std::optional<FoundEllipse> used_;
  double own_errors_rad_ = 0.0; // of the ellipse in use, without the difference to others
  std::uint64_t used_for_ = 0;  // samples
  std::deque<Part> parts_;
  std::uint64_t parts_done_ = 0;
  std::vector<double> kept_u1_;
  std::vector<double> kept_u2_;
  std::size_t next_try_ = 0; // number of pairs
  std::string problem_;
};

} // namespace dyncal::drivers::interferometer
