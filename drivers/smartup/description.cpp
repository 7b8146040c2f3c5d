#include "drivers/smartup/description.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace dyncal::drivers::smartup {

namespace {

constexpr std::uint32_t types_to_come = 0b1111011; // all but UNCERTAINTY_TYPE, which no unit sends
constexpr std::size_t first_adc_channel = 10;      // Data_11..13 of the calibration firmware
constexpr std::size_t last_adc_channel = 12;

struct HierarchyPlace {
  std::string group;                // as declared
  std::optional<std::size_t> index; // absent: malformed
};

HierarchyPlace place_of(const std::string& hierarchy) {
  const auto slash = hierarchy.find('/');
  if (slash == std::string::npos) {
    return {hierarchy, std::nullopt};
  }
  const std::string index = hierarchy.substr(slash + 1);
  const bool digits =
      !index.empty() && index.size() <= 2 &&
      std::ranges::all_of(index, [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!digits) {
    return {hierarchy.substr(0, slash), std::nullopt};
  }
  return {hierarchy.substr(0, slash), std::stoul(index)};
}

// Lower case; whatever is neither letter nor digit becomes one underscore.
std::string identifier(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0 && byte < 0x80) {
      name += static_cast<char>(std::tolower(byte));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') {
    name.pop_back();
  }
  return name;
}

std::string two_digits(std::size_t number) {
  return {static_cast<char>('0' + number / 10), static_cast<char>('0' + number % 10)};
}

std::string data_name(std::size_t channel) {
  return "Data_" + two_digits(channel + 1);
}

std::optional<double> finite(const std::optional<float>& value) {
  if (!value || !std::isfinite(*value)) {
    return std::nullopt;
  }
  return static_cast<double>(*value);
}

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

const std::string* configured_name(const ChannelNaming& naming,
                                   std::initializer_list<std::string> keys) {
  for (const auto& key : keys) {
    for (const auto& [device_name, ours] : naming.names) {
      if (!key.empty() && in_lower_case(device_name) == in_lower_case(key)) {
        return &ours;
      }
    }
  }
  return nullptr;
}

void make_names_unique(std::vector<ChannelDescription>& channels,
                       const std::vector<std::size_t>& numbers) {
  for (std::size_t i = 1; i < channels.size(); ++i) {
    const auto end = channels.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find_if(channels.begin(), end,
                     [&](const auto& other) { return other.name == channels[i].name; }) != end) {
      channels[i].name.append("_").append(two_digits(numbers[i] + 1));
    }
  }
}

} // namespace

std::string d_si_unit(const std::string& text) {
  static const std::map<std::string, std::string> known_wrong = {
      {"\\seconds", "\\second"},
      {"\\nanoseconds", "\\nano\\second"},
      {"\\A.U.", "\\one"},
      {"/hertz", "\\hertz"}};
  const auto known = known_wrong.find(text);
  return known == known_wrong.end() ? text : known->second;
}

bool DescriptionAssembly::add(const DescriptionMessage& message) {
  bool is_new = sensor_name_ != message.sensor_name;
  sensor_name_ = message.sensor_name;
  const std::uint32_t type = 1U << static_cast<unsigned>(message.type);
  is_new = is_new || (types_seen_ & type) == 0;
  types_seen_ |= type;
  const auto update = [&](auto& kept, auto said) {
    if (kept == said) {
      return;
    }
    kept = std::move(said);
    is_new = true;
  };
  for (std::size_t i = 0; i < channels_of_unit; ++i) {
    Declared& declared = declared_[i];
    switch (message.type) {
    case DescriptionType::physical_quantity:
      update(declared.quantity, message.texts[i].value_or(""));
      break;
    case DescriptionType::unit:
      update(declared.unit, message.texts[i].value_or(""));
      break;
    case DescriptionType::hierarchy:
      update(declared.hierarchy, message.texts[i].value_or(""));
      break;
    case DescriptionType::resolution:
      update(declared.steps, finite(message.numbers[i]));
      break;
    case DescriptionType::min_scale:
      update(declared.minimum, finite(message.numbers[i]));
      break;
    case DescriptionType::max_scale:
      update(declared.maximum, finite(message.numbers[i]));
      break;
    case DescriptionType::uncertainty_type:
      break;
    }
  }
  return is_new;
}

bool DescriptionAssembly::complete() const {
  return (types_seen_ & types_to_come) == types_to_come;
}

std::string DescriptionAssembly::declared_name(std::size_t channel) const {
  const HierarchyPlace place = place_of(declared_[channel].hierarchy);
  std::string group = identifier(place.group);
  if (group.empty() || !place.index) {
    return group;
  }
  std::uint32_t indices = 0;
  int members = 0;
  for (const Declared& other : declared_) {
    const HierarchyPlace other_place = place_of(other.hierarchy);
    if (other_place.group != place.group) {
      continue;
    }
    ++members;
    if (other_place.index && *other_place.index < 3) {
      indices |= 1U << *other_place.index;
    }
  }
  if (members == 1) {
    return group;
  }
  if (members == 3 && indices == 0b111 && group != "voltage") {
    return group + "_" + "xyz"[*place.index];
  }
  return group + "_" + std::to_string(*place.index);
}

std::vector<ChannelDescription> DescriptionAssembly::channels(std::uint16_t columns,
                                                              const ChannelNaming& naming,
                                                              const std::string& prefix) const {
  std::vector<ChannelDescription> channels;
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < channels_of_unit; ++i) {
    if ((columns & (1U << i)) == 0) {
      continue;
    }
    const Declared& declared = declared_[i];
    ChannelDescription channel;
    const std::string name = declared_name(i);
    channel.name = name.empty() ? prefix + in_lower_case(data_name(i)) : name;
    if (const auto* ours =
            configured_name(naming, {prefix + data_name(i),
                                     prefix.empty() ? declared.hierarchy : "", channel.name})) {
      channel.name = *ours;
    }
    channel.quantity = declared.quantity;
    channel.unit = d_si_unit(declared.unit);
    const bool undeclared =
        declared.quantity.empty() && declared.unit.empty() && declared.hierarchy.empty();
    if (undeclared && i >= first_adc_channel && i <= last_adc_channel) {
      channel.quantity = "Voltage";
      channel.unit = "\\volt";
    }
    if (declared.minimum && declared.maximum) {
      channel.minimum = *declared.minimum;
      channel.maximum = *declared.maximum;
      if (declared.steps && *declared.steps > 0.0) {
        channel.resolution = (channel.maximum - channel.minimum) / *declared.steps;
      }
    }
    channels.push_back(std::move(channel));
    numbers.push_back(i);
  }
  make_names_unique(channels, numbers);
  for (auto& channel : channels) {
    if (const auto unit = naming.units.find(channel.name); unit != naming.units.end()) {
      channel.unit = unit->second;
    }
  }
  return channels;
}

std::vector<std::string> DescriptionAssembly::warnings() const {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < channels_of_unit; ++i) {
    const Declared& declared = declared_[i];
    if (!declared.hierarchy.empty() && !place_of(declared.hierarchy).index) {
      warnings.push_back(data_name(i) + ": hierarchy without index: '" + declared.hierarchy + "'");
    }
    if (const std::string unit = d_si_unit(declared.unit); unit != declared.unit) {
      warnings.push_back(data_name(i) + ": unit '" + declared.unit +
                         "' is not D-SI and is taken as '" + unit + "'");
    }
  }
  return warnings;
}

} // namespace dyncal::drivers::smartup
