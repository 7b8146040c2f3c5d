#include "analysis/interferometer/record_ellipse.hpp"

#include <algorithm>
#include <vector>

namespace dyncal::analysis {
namespace {

constexpr std::size_t record_block = 65536;

struct SeenPhase {
  double turns_covered = 0.0;
  std::optional<RadiusHarmonics> radius;
};

template <class Number>
Expected<SeenPhase> phase_through(const Ellipse& ellipse, std::span<const Number> u1,
                                  std::span<const Number> u2) {
  QuadraturePhase phase(ellipse);
  std::vector<double> turns(std::min(u1.size(), record_block));
  for (std::size_t begin = 0; begin < u1.size(); begin += record_block) {
    const std::size_t n = std::min(record_block, u1.size() - begin);
    DYNCAL_TRY(phase.push(u1.subspan(begin, n), u2.subspan(begin, n), std::span(turns).first(n)));
  }
  return SeenPhase{phase.statistics().turns_covered(), phase.radius_over_phase().harmonics()};
}

template <class Number>
Expected<RecordEllipse> fit_record(std::span<const Number> u1, std::span<const Number> u2) {
  if (u1.size() != u2.size()) {
    return fail(ErrorCode::invalid_argument,
                "the two signals of the interferometer have different numbers of samples");
  }
  EllipseMoments moments;
  moments.add(u1, u2);
  DYNCAL_TRY(const EllipseFit first, fit_ellipse_by(EllipseMethod::linear, moments));
  DYNCAL_TRY(SeenPhase seen, phase_through(first.ellipse, u1, u2));
  DYNCAL_TRY(EllipseFit fit, fit_ellipse(moments, seen.turns_covered));
  if (fit.method == EllipseMethod::adjusted) { // noise makes the first ellipse small, arcs long
    DYNCAL_TRY(seen, phase_through(fit.ellipse, u1, u2));
    DYNCAL_TRY(fit, fit_ellipse(moments, seen.turns_covered));
  }
  return RecordEllipse{fit, seen.radius};
}

} // namespace

Expected<RecordEllipse> ellipse_of_record(std::span<const std::int16_t> u1,
                                          std::span<const std::int16_t> u2) {
  return fit_record(u1, u2);
}

Expected<RecordEllipse> ellipse_of_record(std::span<const float> u1, std::span<const float> u2) {
  return fit_record(u1, u2);
}

Expected<RecordEllipse> ellipse_of_record(std::span<const double> u1, std::span<const double> u2) {
  return fit_record(u1, u2);
}

} // namespace dyncal::analysis
