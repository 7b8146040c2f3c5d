#include "services/views/signals/sine_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dyncal::inline views {
namespace {

constexpr double shown_periods = 4.0;

double value_of(const analysis::SineFit& fit, const analysis::Frequency& frequency,
                std::int64_t time_ns) {
  const double angle = 2.0 * std::numbers::pi * frequency.reduced_turns(time_ns);
  return fit.sine * std::sin(angle) + fit.cosine * std::cos(angle) + fit.offset;
}

// Smallest and largest of so many parts.
std::vector<TraceColumn> columns_of(std::span<const Sample> samples, std::size_t count) {
  std::vector<TraceColumn> columns;
  const std::size_t together = std::max<std::size_t>(1, (samples.size() + count - 1) / count);
  for (std::size_t first = 0; first < samples.size(); first += together) {
    const auto part = samples.subspan(first, std::min(together, samples.size() - first));
    const auto [low, high] = std::ranges::minmax_element(
        part, [](const Sample& a, const Sample& b) { return a.value < b.value; });
    const auto since_ns = static_cast<double>(part.front().stamp_ns - samples.front().stamp_ns);
    columns.push_back({since_ns * 1e-9, low->value, high->value});
  }
  return columns;
}

// As if the scatter were of every fit: it has no reason to be less over a longer time.
void widen(double scatter, analysis::SineFit& fit) {
  const double u = fit.u_amplitude();
  const double times = u > 0.0 ? 1.0 + scatter * scatter / (u * u) : 1.0;
  for (double& one : fit.covariance) {
    one *= times;
  }
}

} // namespace

Expected<SineView> view_sine(const SettledSamples& settled, std::size_t columns) {
  const analysis::Frequency& frequency = settled.frequency;
  const auto fitted = settled.samples.last(std::min(settled.samples.size(), max_fitted_samples));
  std::vector<std::int64_t> stamps_ns;
  std::vector<double> values;
  stamps_ns.reserve(fitted.size());
  values.reserve(fitted.size());
  for (const Sample& sample : fitted) {
    stamps_ns.push_back(sample.stamp_ns);
    values.push_back(sample.value);
  }
  const std::int64_t origin_ns = stamps_ns[stamps_ns.size() / 2];
  const std::vector<std::span<const double>> channels{values};
  const auto fits = analysis::fit_sine(frequency, origin_ns, stamps_ns, channels);
  if (!fits) {
    return fail(ErrorCode::no_source, fits.error().message);
  }
  SineView view{.fit = fits->front(), .phase_origin_ns = origin_ns, .columns = {}, .residuals = {}};
  std::vector<Sample> residuals;
  residuals.reserve(fitted.size());
  for (const Sample& sample : fitted) {
    residuals.push_back({sample.stamp_ns, sample.value - value_of(view.fit, frequency,
                                                                  sample.stamp_ns - origin_ns)});
  }
  widen(settled.scatter, view.fit);
  view.residual_rms = std::sqrt(view.fit.rss / static_cast<double>(fitted.size()));
  view.residuals = columns_of(residuals, columns);
  const auto shown_ns = static_cast<std::int64_t>(shown_periods * 1e9 / frequency.hz());
  const auto shown = std::ranges::find_if(fitted, [&](const Sample& sample) {
    return sample.stamp_ns >= fitted.back().stamp_ns - shown_ns;
  });
  view.columns = columns_of(std::span(shown, fitted.end()), columns);
  return view;
}

} // namespace dyncal::inline views
