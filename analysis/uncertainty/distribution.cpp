#include "analysis/uncertainty/distribution.hpp"

#include <cmath>

namespace dyncal::analysis {

std::string_view to_string(Distribution distribution) {
  switch (distribution) {
  case Distribution::normal:
    return "normal";
  case Distribution::rectangular:
    return "rectangular";
  case Distribution::triangular:
    return "triangular";
  case Distribution::arcsine:
    return "arcsine";
  }
  return "unknown";
}

std::optional<Distribution> parse_distribution(std::string_view text) {
  for (const Distribution distribution : {Distribution::normal, Distribution::rectangular,
                                          Distribution::triangular, Distribution::arcsine}) {
    if (text == to_string(distribution)) {
      return distribution;
    }
  }
  return std::nullopt;
}

double standard_uncertainty(Distribution distribution, double half_width) {
  switch (distribution) {
  case Distribution::normal:
    return half_width / 2.0;
  case Distribution::rectangular:
    return half_width / std::sqrt(3.0);
  case Distribution::triangular:
    return half_width / std::sqrt(6.0);
  case Distribution::arcsine:
    return half_width / std::sqrt(2.0);
  }
  return half_width;
}

} // namespace dyncal::analysis
