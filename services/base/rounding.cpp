#include "services/base/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <fmt/core.h>

namespace dyncal::inline base {
namespace {

constexpr double min_without_exponent = 1e-3; // of the larger of value and u
constexpr double max_without_exponent = 1e7;
constexpr int max_digits = 17; // a double has no more
constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

bool is_usable(double u) {
  return std::isfinite(u) && u > 0.0;
}

// Of the leading digit once it is rounded to `digits` digits: 0.0996 is 0.10.
int exponent_of(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", value, digits - 1);
  return std::atoi(text.c_str() + text.find('e') + 1);
}

// To a multiple of 10^place, as a whole number of them.
std::string round_to_place(double value, int place) {
  const double unit = std::pow(10.0, place);
  const double rounded = place > 0 ? std::round(value / unit) * unit : value;
  const std::string text = fmt::format("{:.{}f}", rounded, std::max(-place, 0));
  // "-0.00" is 0.
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : text;
}

std::string with_exponent(double value, int place) {
  if (std::abs(value) < 0.5 * std::pow(10.0, place)) {
    return "0";
  }
  // Rounding may carry into a digit more: 9.96e-6 to 1e-7 is 1.00e-05.
  int digits = std::clamp(exponent_of(value, max_digits) - place + 1, 1, max_digits);
  const double rounded = std::strtod(fmt::format("{:.{}e}", value, digits - 1).c_str(), nullptr);
  digits = std::clamp(exponent_of(rounded, digits) - place + 1, 1, max_digits);
  return fmt::format("{:.{}e}", rounded, digits - 1);
}

bool needs_exponent(double size) {
  return size < min_without_exponent || size >= max_without_exponent;
}

} // namespace

std::string rounded_uncertainty(double u) {
  if (!is_usable(u)) {
    return fmt::format("{:g}", u);
  }
  return needs_exponent(u) ? fmt::format("{:.1e}", u) : round_to_place(u, exponent_of(u, 2) - 1);
}

RoundedValue round_by_uncertainty(double value, double u) {
  if (!std::isfinite(value) || !is_usable(u)) {
    return {std::isfinite(value) ? fmt::format("{:.6g}", value) : fmt::format("{:g}", value),
            rounded_uncertainty(u)};
  }
  const int place = exponent_of(u, 2) - 1;
  if (needs_exponent(std::max(std::abs(value), u))) {
    return {with_exponent(value, place), fmt::format("{:.1e}", u)};
  }
  return {round_to_place(value, std::max(place, -max_digits)),
          u < 1e-9 ? fmt::format("{:.1e}", u) : round_to_place(u, place)};
}

RoundedPhase round_phase(double phase_rad, double u_rad) {
  const auto rounded = [&](double phase) {
    return RoundedPhase{
        round_by_uncertainty(phase, u_rad),
        round_by_uncertainty(degrees_per_radian * phase, degrees_per_radian * u_rad)};
  };
  RoundedPhase result = rounded(phase_rad);
  if (std::strtod(result.degrees.value.c_str(), nullptr) == -180.0) {
    result = rounded(phase_rad + 2.0 * std::numbers::pi);
  }
  return result;
}

} // namespace dyncal::inline base
