#include "analysis/method/start_latency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace dyncal::analysis {
namespace {

constexpr double probable_fixed = 0.3; // hardly any clean step falls below: 3 in 1000
constexpr double improbable_uniform = 0.05;
constexpr double probable_uniform = 0.6; // 95 % of runs of five shots that are
constexpr std::size_t widths = 16;       // of the grid of W and of s
constexpr std::size_t places = 24;       // of that of m
constexpr double least_density = 1e-300; // its logarithm must exist
constexpr double least_noise = 1e-6;     // T: data without noise must not divide by 0
constexpr double least_width = 1e-3;     // T: narrower ones cannot matter
constexpr double largest_scatter = 3.0;  // T: of waiting and jitter
constexpr std::size_t shots_to_decide = 3;

struct Prior {
  double fixed, uniform, other;
};

Prior prior_after(StartKind other_steps) {
  switch (other_steps) {
  case StartKind::fixed:
    return {0.93, 0.02, 0.05};
  case StartKind::uniform:
    return {0.02, 0.93, 0.05};
  case StartKind::undecided:
    break;
  }
  return {0.42, 0.33, 0.25};
}

double normal_distribution(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

// The offsets about their mean, and what every hypothesis needs of them.
struct Offsets {
  std::vector<double> values_s;
  double u_s = 0.0;
  double low_s = 0.0, high_s = 0.0;
  double squares_s2 = 0.0;

  [[nodiscard]] double count() const { return static_cast<double>(values_s.size()); }
};

Offsets about_mean(std::span<const double> offsets_s, double u_s) {
  Offsets result;
  result.u_s = u_s;
  double mean = 0.0;
  for (const double offset : offsets_s) {
    mean += offset / static_cast<double>(offsets_s.size());
  }
  for (const double offset : offsets_s) {
    result.values_s.push_back(offset - mean);
    result.squares_s2 += (offset - mean) * (offset - mean);
  }
  const auto [low, high] = std::minmax_element(result.values_s.begin(), result.values_s.end());
  result.low_s = *low;
  result.high_s = *high;
  return result;
}

// Integral over the place from `first` to `last` of the product of densities, as a logarithm.
template <class LogDensity>
double integrated(const Offsets& offsets, double first, double last, LogDensity log_density) {
  std::array<double, places> logs{};
  const double step = (last - first) / static_cast<double>(places - 1);
  for (std::size_t i = 0; i < places; ++i) {
    const double place = first + step * static_cast<double>(i);
    for (const double value : offsets.values_s) {
      logs[i] += log_density(value - place);
    }
  }
  const double largest = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double one : logs) {
    sum += std::exp(one - largest);
  }
  return largest + std::log(sum * step);
}

double log_normal(const Offsets& offsets, double variance) {
  const double n = offsets.count();
  return -0.5 * ((n - 1.0) * std::log(2.0 * std::numbers::pi * variance) + std::log(n) +
                 offsets.squares_s2 / variance);
}

double log_rectangle(const Offsets& offsets, double width) {
  const double u = offsets.u_s;
  const double middle = 0.5 * (offsets.low_s + offsets.high_s);
  const double reach = 0.5 * std::abs(width - (offsets.high_s - offsets.low_s)) + 4.0 * u;
  return integrated(offsets, middle - reach, middle + reach, [&](double x) {
    const double density =
        (normal_distribution((x + 0.5 * width) / u) - normal_distribution((x - 0.5 * width) / u)) /
        width;
    return std::log(std::max(density, least_density));
  });
}

double log_exponential(const Offsets& offsets, double mean) {
  const double u = offsets.u_s;
  constexpr double largest_exponent = 600.0;
  const double before = 8.0 * mean / offsets.count() + 4.0 * u;
  return integrated(offsets, offsets.low_s - before, offsets.low_s + 3.0 * u, [&](double x) {
    const double exponent = std::min(0.5 * u * u / (mean * mean) - x / mean, largest_exponent);
    const double density =
        std::exp(exponent) * std::erfc((u / mean - x / u) / std::numbers::sqrt2) / (2.0 * mean);
    return std::log(std::max(density, least_density));
  });
}

// The middle of step i of a grid that is even in the logarithm.
double width_of(std::size_t i, double low, double high) {
  return low * std::pow(high / low, (static_cast<double>(i) + 0.5) / static_cast<double>(widths));
}

struct Hypothesis {
  double log_weight;
  double latency_s; // mean
};

std::vector<Hypothesis> hypotheses_of(const Offsets& offsets, double sample_s, const Prior& prior) {
  std::vector<Hypothesis> result{
      {std::log(prior.fixed) + log_normal(offsets, offsets.u_s * offsets.u_s), 0.0},
      {std::log(prior.uniform) + log_rectangle(offsets, sample_s), 0.5 * sample_s}};
  const double each = std::log(prior.other / 3.0 / static_cast<double>(widths));
  const double low = std::max(0.5 * offsets.u_s, least_width * sample_s);
  const double narrowest = std::min(std::sqrt(3.0) * low, 0.5 * sample_s);
  const double least_scatter = std::min(low, sample_s);
  for (std::size_t i = 0; i < widths; ++i) {
    const double width = width_of(i, narrowest, sample_s);
    const double scatter = width_of(i, least_scatter, largest_scatter * sample_s);
    result.push_back({each + log_rectangle(offsets, width), 0.5 * width});
    result.push_back({each + log_exponential(offsets, scatter), scatter});
    result.push_back(
        {each + log_normal(offsets, std::pow(std::hypot(offsets.u_s, scatter), 2)), 0.0});
  }
  return result;
}

} // namespace

StartLatency judge_start_latency(std::span<const double> offsets_s, double u_s, double sample_s,
                                 StartKind other_steps) {
  StartLatency result;
  if (offsets_s.empty() || !(sample_s > 0.0)) {
    return result;
  }
  const Offsets offsets = about_mean(offsets_s, std::max(u_s, least_noise * sample_s));
  if (offsets_s.size() > 1) {
    result.scatter_s = std::sqrt(offsets.squares_s2 / (offsets.count() - 1.0));
  }
  const std::vector<Hypothesis> all = hypotheses_of(offsets, sample_s, prior_after(other_steps));
  double largest = all.front().log_weight;
  for (const Hypothesis& one : all) {
    largest = std::max(largest, one.log_weight);
  }
  double total = 0.0;
  for (const Hypothesis& one : all) {
    total += std::exp(one.log_weight - largest);
  }
  const auto probability = [&](const Hypothesis& one) {
    return std::exp(one.log_weight - largest) / total;
  };
  result.probability_fixed = probability(all[0]);
  result.probability_uniform = probability(all[1]);
  if (offsets_s.size() >= shots_to_decide || other_steps != StartKind::undecided) {
    if (result.probability_uniform > probable_uniform) {
      result.kind = StartKind::uniform;
      result.latency_s = 0.5 * sample_s;
    } else if (result.probability_fixed > probable_fixed &&
               result.probability_uniform < improbable_uniform) {
      result.kind = StartKind::fixed;
    }
  }
  double square = 0.0;
  for (const Hypothesis& one : all) {
    square += probability(one) * std::pow(one.latency_s - result.latency_s, 2);
  }
  result.u_latency_s = std::sqrt(square);
  return result;
}

const char* to_string(StartKind kind) {
  switch (kind) {
  case StartKind::fixed:
    return "with the trigger";
  case StartKind::uniform:
    return "uniform over one sample after the trigger";
  case StartKind::undecided:
    break;
  }
  return "undecided, taken as with the trigger";
}

} // namespace dyncal::analysis
