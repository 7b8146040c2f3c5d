#include "drivers/files/tdms/tdms_scaling.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace dyncal::drivers::files {
namespace {

using Problem = tl::unexpected<std::string>;

constexpr std::int64_t max_coefficients = 1000;
constexpr std::int64_t usual_coefficients = 4; // where their number is not stated

std::string name_of(std::int64_t scale) {
  return "NI_Scale[" + std::to_string(scale) + "]";
}

// Where their number is not stated, the highest of them tells it.
std::int64_t highest_scale(const TdmsProperties& properties) {
  std::int64_t scales = 0;
  for (const auto& [name, value] : properties) {
    constexpr std::string_view begin = "NI_Scale[";
    std::int64_t scale = -1;
    if (name.starts_with(begin) && name.ends_with("]_Scale_Type")) {
      std::from_chars(name.data() + begin.size(), name.data() + name.size(), scale);
    }
    scales = std::max(scales, std::min(scale, std::int64_t{tdms_raw_input}) + 1);
  }
  return scales;
}

// How many scalings are stated; nothing where values are as they should be.
std::optional<std::int64_t> scales_in(const TdmsProperties& properties) {
  const std::optional<std::int64_t> scales =
      whole_number_in(properties, "NI_Number_Of_Scales").value_or(highest_scale(properties));
  const bool done = text_in(properties, "NI_Scaling_Status") == "scaled";
  return scales && *scales > 0 && !done ? scales : std::nullopt;
}

} // namespace

tl::expected<TdmsScaling, std::string> TdmsScaling::of(const TdmsProperties& channel,
                                                       const TdmsProperties& group,
                                                       const TdmsProperties& file) {
  for (const TdmsProperties* properties : {&channel, &group, &file}) {
    if (const auto scales = scales_in(*properties)) {
      return of(*properties, *scales);
    }
  }
  return TdmsScaling();
}

tl::expected<TdmsScaling, std::string> TdmsScaling::of(const TdmsProperties& properties,
                                                       std::int64_t scales) {
  TdmsScaling scaling;
  for (std::int64_t at = scales - 1;;) {
    const std::string type = text_in(properties, name_of(at) + "_Scale_Type");
    if (type.empty()) {
      scaling.scaler_ = static_cast<std::uint32_t>(at);
      break;
    }
    const std::string begin = name_of(at) + "_" + type;
    Scale scale;
    scale.is_linear = type == "Linear";
    const auto add = [&](const std::string& name) {
      const auto number = number_in(properties, begin + name);
      scale.coefficients.push_back(number.value_or(0.0));
      return number.has_value();
    };
    bool is_whole = true;
    if (scale.is_linear) {
      is_whole = add("_Y_Intercept") && add("_Slope");
    } else if (type == "Polynomial") {
      const std::int64_t size =
          whole_number_in(properties, begin + "_Coefficients_Size").value_or(usual_coefficients);
      is_whole = size >= 0 && size <= max_coefficients;
      for (std::int64_t i = 0; is_whole && i < size; ++i) {
        is_whole = add("_Coefficients[" + std::to_string(i) + "]");
      }
    } else {
      return Problem("has the scaling \"" + type +
                     "\", which is not known here (Linear and Polynomial are); let LabVIEW write "
                     "scaled values");
    }
    if (!is_whole) {
      return Problem("has the scaling " + begin + " without all its numbers");
    }
    scaling.scales_.push_back(std::move(scale));
    const std::int64_t input =
        whole_number_in(properties, begin + "_Input_Source").value_or(tdms_raw_input);
    if (input == tdms_raw_input) {
      break;
    }
    if (input < 0 || input >= at) {
      return Problem("has the scaling " + begin + " of what only comes behind it");
    }
    at = input;
  }
  std::reverse(scaling.scales_.begin(), scaling.scales_.end());
  return scaling;
}

void TdmsScaling::apply(std::span<double> values) const {
  for (const Scale& scale : scales_) {
    const std::vector<double>& numbers = scale.coefficients;
    if (scale.is_linear) {
      for (double& value : values) {
        value = value * numbers[1] + numbers[0];
      }
      continue;
    }
    for (double& value : values) { // as Horner has it
      double sum = numbers.empty() ? 0.0 : numbers.back() + value * 0.0;
      for (std::size_t i = numbers.size(); i > 1; --i) {
        sum = numbers[i - 2] + sum * value;
      }
      value = sum;
    }
  }
}

} // namespace dyncal::drivers::files
