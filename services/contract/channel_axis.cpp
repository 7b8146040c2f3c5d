#include "services/contract/channel_axis.hpp"

#include <algorithm>
#include <cctype>

namespace dyncal::inline contract {
namespace {

bool is_small(char letter) {
  return std::islower(static_cast<unsigned char>(letter)) != 0;
}

// 'x', 'y' or 'z', whatever its sign and case; 0 for another name.
char letter_of(std::string_view axis) {
  if (axis.starts_with('+') || axis.starts_with('-')) {
    axis.remove_prefix(1);
  }
  const char letter =
      axis.size() == 1 ? static_cast<char>(std::tolower(static_cast<unsigned char>(axis.front())))
                       : '\0';
  return letter == 'x' || letter == 'y' || letter == 'z' ? letter : '\0';
}

} // namespace

std::string axis_of(std::string_view channel, std::span<const ChannelAxis> stated) {
  const auto found = std::ranges::find(stated, channel, &ChannelAxis::channel);
  if (found != stated.end()) {
    return found->axis;
  }
  if (channel.size() < 2) {
    return {};
  }
  const char last = channel.back();
  const char before = channel[channel.size() - 2];
  const bool is_part = before == '_' || before == '-' || before == '/' || before == ' ' ||
                       (is_small(before) && !is_small(last));
  const char letter = is_part ? letter_of(std::string_view(&last, 1)) : '\0';
  return letter == '\0' ? std::string() : std::string(1, letter);
}

bool is_of_x_y_z(std::string_view axis) {
  return letter_of(axis) != '\0';
}

bool lies_across(std::string_view axis, std::string_view excited) {
  const char one = letter_of(axis);
  const char other = letter_of(excited);
  return one != '\0' && other != '\0' && one != other;
}

} // namespace dyncal::inline contract
