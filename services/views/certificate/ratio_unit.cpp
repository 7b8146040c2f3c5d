#include "services/views/certificate/ratio_unit.hpp"

#include <string_view>

#include "services/contract/unit.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::string_view power = "\\tothe{";

// Each unit of a product to the opposite power; nothing for what has \per already.
std::optional<std::string> inverse_of(std::string_view product) {
  std::string inverse;
  while (!product.empty()) {
    std::string_view unit = product.substr(0, product.find('\\', 1));
    product.remove_prefix(unit.size());
    if (unit == "\\per") {
      return std::nullopt;
    }
    inverse += unit;
    const bool is_prefix = product.empty() ? false : to_d_si(std::string(unit)) == std::nullopt;
    if (is_prefix) {
      continue;
    }
    if (product.starts_with(power)) {
      const std::size_t end = product.find('}');
      if (end == std::string_view::npos) {
        return std::nullopt;
      }
      std::string exponent(product.substr(power.size(), end - power.size()));
      exponent = exponent.starts_with('-') ? exponent.substr(1) : "-" + exponent;
      product.remove_prefix(end + 1);
      inverse += exponent == "1" ? "" : std::string(power) + exponent + "}";
    } else {
      inverse += std::string(power) + "-1}";
    }
  }
  return inverse;
}

} // namespace

std::optional<std::string> ratio_in_d_si(const std::string& unit) {
  if (const auto known = to_d_si(unit)) {
    return known;
  }
  const std::size_t middle = unit.find(")/(");
  if (!unit.starts_with('(') || !unit.ends_with(')') || middle == std::string::npos) {
    return std::nullopt;
  }
  const auto output = to_d_si(unit.substr(1, middle - 1));
  const auto input = to_d_si(unit.substr(middle + 3, unit.size() - middle - 4));
  const auto inverse = input ? inverse_of(*input) : std::nullopt;
  if (!output || !inverse) {
    return std::nullopt;
  }
  return *input == "\\one" ? *output : (*output == "\\one" ? *inverse : *output + *inverse);
}

} // namespace dyncal::inline views
