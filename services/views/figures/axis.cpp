#include "services/views/figures/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/core.h>

namespace dyncal::inline views::figures {
namespace {

bool showable(Scale scale, double value) {
  return std::isfinite(value) && (scale == Scale::linear || value > 0);
}

// With a true minus sign, and no minus before a zero.
std::string decimal(double value, int decimals) {
  const double min_shown = 0.5 * std::pow(10.0, -decimals);
  if (std::abs(value) < min_shown) {
    return fmt::format("{:.{}f}", 0.0, decimals);
  }
  const auto digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  return value < 0 ? "−" + digits : digits;
}

// The power of ten that leaves labels short; 0 where plain numbers are short already.
int common_exponent(double low, double high) {
  const double largest = std::max(std::abs(low), std::abs(high));
  if (largest == 0 || (largest >= 1e-2 && largest < 1e5)) {
    return 0;
  }
  return static_cast<int>(std::floor(std::log10(largest)));
}

double nice_step(double span, int ticks) {
  const double raw = span / std::max(ticks, 1);
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double mantissa : {1.0, 2.0, 5.0}) {
    if (mantissa * decade >= raw * 0.999) {
      return mantissa * decade;
    }
  }
  return 10 * decade;
}

int decimals_for(double step) {
  return std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
}

void add_linear_ticks(Axis& axis, int ticks) {
  const double step = nice_step(axis.high - axis.low, ticks);
  const int exponent = common_exponent(axis.low, axis.high);
  const double unit = std::pow(10.0, exponent);
  const int decimals = decimals_for(step / unit);
  const double slack = 1e-9 * step;
  for (double index = std::ceil((axis.low - slack) / step); index * step <= axis.high + slack;
       ++index) {
    axis.ticks.push_back({index * step, decimal(index * step / unit, decimals)});
  }
  if (exponent != 0) {
    axis.factor = "×" + power_of_ten(exponent);
  }
}

std::string logarithmic_label(int mantissa, int exponent, bool plain) {
  const double value = mantissa * std::pow(10.0, exponent);
  if (plain) {
    return decimal(value, std::max(0, -exponent));
  }
  return mantissa == 1 ? power_of_ten(exponent)
                       : fmt::format("{}×{}", mantissa, power_of_ten(exponent));
}

void add_logarithmic_ticks(Axis& axis, int ticks) {
  const double decades = std::log10(axis.high / axis.low);
  if (decades < 0.5) {
    return add_linear_ticks(axis, ticks);
  }
  const bool plain = axis.low >= 1e-3 && axis.high < 1e5;
  const int every = std::max(1, static_cast<int>(std::ceil(decades / std::max(ticks, 1))));
  const int first = static_cast<int>(std::floor(std::log10(axis.low)));
  const int last = static_cast<int>(std::ceil(std::log10(axis.high)));
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int mantissa = 1; mantissa <= 9; ++mantissa) {
      const double value = mantissa * std::pow(10.0, exponent);
      if (value < axis.low * (1 - 1e-9) || value > axis.high * (1 + 1e-9)) {
        continue;
      }
      const bool power = mantissa == 1 && (exponent % every) == 0;
      const bool between = (mantissa == 2 || mantissa == 5) && 2.5 * decades <= ticks;
      if (power || between) {
        axis.ticks.push_back({value, logarithmic_label(mantissa, exponent, plain)});
      } else if (decades <= 6) {
        axis.ticks.push_back({value, ""});
      }
    }
  }
}

} // namespace

double Axis::position(double value) const {
  if (scale == Scale::linear) {
    return (value - low) / (high - low);
  }
  return std::log(value / low) / std::log(high / low);
}

bool Axis::can_show(double value) const {
  return showable(scale, value);
}

void Range::include(double value) {
  if (!showable(scale_, value)) {
    return;
  }
  const bool first = empty();
  low_ = first ? value : std::min(low_, value);
  high_ = first ? value : std::max(high_, value);
}

void Range::include(std::span<const double> values) {
  for (const double value : values) {
    include(value);
  }
}

Range Range::padded(double fraction) const {
  Range result(scale_);
  if (empty()) {
    result.low_ = scale_ == Scale::linear ? 0 : 1;
    result.high_ = scale_ == Scale::linear ? 1 : 10;
    return result;
  }
  if (scale_ == Scale::logarithmic) {
    const double ratio = high_ > low_ * (1 + 1e-12) ? std::pow(high_ / low_, fraction) : 2.0;
    result.low_ = low_ / ratio;
    result.high_ = high_ * ratio;
    return result;
  }
  const double span = high_ - low_;
  const double magnitude = std::max(std::abs(low_), std::abs(high_));
  double room = fraction * span;
  if (span <= 1e-12 * magnitude) {
    room = 0.05 * magnitude;
  }
  if (magnitude == 0) {
    room = 1;
  }
  result.low_ = low_ - room;
  result.high_ = high_ + room;
  return result;
}

Axis make_axis(const Range& range, int ticks) {
  const Range shown = range.high() > range.low() ? range : range.padded(0.0); // ticks need a step
  Axis axis{shown.scale(), shown.low(), shown.high(), {}, {}};
  if (axis.scale == Scale::linear) {
    add_linear_ticks(axis, ticks);
  } else {
    add_logarithmic_ticks(axis, ticks);
  }
  return axis;
}

Axis make_axis(const Range& range, std::span<const double> ticks, double character) {
  Axis axis = make_axis(range, 1);
  axis.ticks.clear();
  axis.factor.clear();
  double labelled_to = -1.0;
  for (const double value : ticks) {
    if (!axis.can_show(value) || value < axis.low || value > axis.high) {
      continue;
    }
    std::string label = fmt::format("{:.4g}", value);
    const double half_width = 0.5 * character * static_cast<double>(label.size());
    const double position = axis.position(value);
    const bool has_room = position - half_width >= labelled_to + character;
    labelled_to = has_room ? position + half_width : labelled_to;
    axis.ticks.push_back({value, has_room ? std::move(label) : std::string()});
  }
  return axis;
}

std::string power_of_ten(int exponent) {
  static constexpr std::array<const char*, 10> superscripts = {"⁰", "¹", "²", "³", "⁴",
                                                               "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string result = exponent < 0 ? "10⁻" : "10";
  for (const char digit : std::to_string(std::abs(exponent))) {
    result += superscripts[static_cast<std::size_t>(digit - '0')];
  }
  return result;
}

} // namespace dyncal::inline views::figures
