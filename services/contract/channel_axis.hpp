// Along which axis a channel measures, and whether that is across the excited one.
//
// A name says it at its end: "acceleration_x", "AccelerationX"; the bench file states it of others.
// Axes are compared without a sign, "-z" is z; others than x, y, z have names of their own, and
// nothing is known of the angle between them. Plain functions; any thread.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace dyncal::inline contract {

struct ChannelAxis {
  std::string channel; // "source/channel"
  std::string axis;
};

// Empty: not known.
[[nodiscard]] std::string axis_of(std::string_view channel, std::span<const ChannelAxis> stated);

// One of x, y, z.
[[nodiscard]] bool is_of_x_y_z(std::string_view axis);

// Both are of x, y, z, and not the same.
[[nodiscard]] bool lies_across(std::string_view axis, std::string_view excited);

} // namespace dyncal::inline contract
