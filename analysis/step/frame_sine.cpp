#include "analysis/step/frame_sine.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::int64_t max_frame_ns = 100'000'000;
constexpr double max_periods = 50.0; // more, and a frequency 1e-3 off would fade within the frame
constexpr double turns_between_lines = 2.0; // in a frame, of the nearest lines of a multi-sine
constexpr double slice_s = 0.05;

struct Design { // of one frame: sine and cosine of every sample, and their means
  std::unique_ptr<double[]> sine;
  std::unique_ptr<double[]> cosine;
  double mean_sine = 0.0;
  double mean_cosine = 0.0;

  Design(const Frequency& frequency, std::int64_t centre_ns,
         std::span<const std::int64_t> stamps_ns)
      : sine(std::make_unique_for_overwrite<double[]>(stamps_ns.size())),
        cosine(std::make_unique_for_overwrite<double[]>(stamps_ns.size())) {
    fill_sine_cosine(frequency, centre_ns, stamps_ns, sine.get(), cosine.get());
    for (std::size_t i = 0; i < stamps_ns.size(); ++i) {
      mean_sine += sine[i];
      mean_cosine += cosine[i];
    }
    mean_sine /= static_cast<double>(stamps_ns.size());
    mean_cosine /= static_cast<double>(stamps_ns.size());
  }
};

struct Parameters { // about the means
  double sine = 0.0;
  double cosine = 0.0;
  double mean_value = 0.0;
  double u_factor = 0.0; // u of the amplitude over the standard deviation of the residuals
};

double mean_about_first(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value - values[0];
  }
  return values[0] + sum / static_cast<double>(values.size());
}

// Empty when sine and cosine look alike at these instants.
std::optional<Parameters> fit_about_means(const Design& design, std::span<const double> values) {
  Parameters fit;
  fit.mean_value = mean_about_first(values);
  double ss = 0.0, sc = 0.0, cc = 0.0, ys = 0.0, yc = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double s = design.sine[i] - design.mean_sine;
    const double c = design.cosine[i] - design.mean_cosine;
    const double y = values[i] - fit.mean_value;
    ss += s * s;
    sc += s * c;
    cc += c * c;
    ys += y * s;
    yc += y * c;
  }
  const double count = static_cast<double>(values.size());
  const double determinant = ss * cc - sc * sc;
  if (determinant < 1e-3 * count * count / 4.0) {
    return std::nullopt;
  }
  fit.sine = (cc * ys - sc * yc) / determinant;
  fit.cosine = (ss * yc - sc * ys) / determinant;
  fit.u_factor = std::sqrt(0.5 * (ss + cc) / determinant);
  return fit;
}

struct Residuals {
  double power = 0.0; // sum of squares
  double max = 0.0;
  double max_neighbours_rms = 0.0; // the larger of each two adjacent slices' smaller one
};

// The frame is divided into slices of `slice_s`, ten at least; stamps rise, so the samples of a
// slice follow one another.
Residuals residuals_of(const Parameters& fit, const Design& design,
                       std::span<const std::int64_t> stamps_ns, std::span<const double> values,
                       std::int64_t begin_ns, std::int64_t frame_ns) {
  const auto slices = static_cast<std::size_t>(
      std::max(10.0, std::ceil(static_cast<double>(frame_ns) * 1e-9 / slice_s)));
  const double slices_a_ns = static_cast<double>(slices) / static_cast<double>(frame_ns);
  const auto slice_of = [&](std::int64_t stamp_ns) {
    const double place = static_cast<double>(stamp_ns - begin_ns) * slices_a_ns;
    return std::min(slices - 1, static_cast<std::size_t>(place));
  };
  Residuals result;
  double before = 0.0;
  std::size_t i = 0;
  for (std::size_t slice = 0; slice < slices; ++slice) {
    const std::size_t first = i;
    double slice_power = 0.0;
    for (; i < values.size() && slice_of(stamps_ns[i]) == slice; ++i) {
      const double residual = values[i] - fit.mean_value -
                              fit.sine * (design.sine[i] - design.mean_sine) -
                              fit.cosine * (design.cosine[i] - design.mean_cosine);
      result.power += residual * residual;
      slice_power += residual * residual;
      result.max = std::max(result.max, std::abs(residual));
    }
    const double rms = i > first ? std::sqrt(slice_power / static_cast<double>(i - first)) : 0.0;
    result.max_neighbours_rms = std::max(result.max_neighbours_rms, std::min(before, rms));
    before = rms;
  }
  return result;
}

} // namespace

std::int64_t frame_length_ns(const Frequency& frequency, const std::vector<Frequency>& beside) {
  const double period_ns = 1e9 / frequency.hz();
  double frame_ns =
      std::max(period_ns, std::min(static_cast<double>(max_frame_ns), max_periods * period_ns));
  std::vector<double> hz{frequency.hz()};
  std::ranges::transform(beside, std::back_inserter(hz), &Frequency::hz);
  std::ranges::sort(hz);
  for (std::size_t i = 1; i < hz.size(); ++i) {
    frame_ns = std::max(frame_ns, 1e9 * turns_between_lines / (hz[i] - hz[i - 1]));
  }
  return std::llround(frame_ns);
}

std::optional<FrameSine> fit_frame(const Frequency& frequency, std::int64_t begin_ns,
                                   std::int64_t frame_ns, std::span<const std::int64_t> stamps_ns,
                                   std::span<const double> values) {
  const Design design(frequency, begin_ns + frame_ns / 2, stamps_ns);
  const auto fit = fit_about_means(design, values);
  if (!fit) {
    return std::nullopt;
  }
  const Residuals residuals = residuals_of(*fit, design, stamps_ns, values, begin_ns, frame_ns);
  FrameSine result;
  result.amplitude = std::hypot(fit->sine, fit->cosine);
  result.phase_rad = std::atan2(fit->cosine, fit->sine);
  result.residual_rms = std::sqrt(residuals.power / (static_cast<double>(values.size()) - 3.0));
  result.u_amplitude = result.residual_rms * fit->u_factor;
  result.max_residual = residuals.max;
  result.max_neighbours_rms = residuals.max_neighbours_rms;
  return result;
}

} // namespace dyncal::analysis
