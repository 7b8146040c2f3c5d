#include "services/programs/command/axis_results.hpp"

#include <utility>

#include <fmt/core.h>

namespace dyncal::inline programs {

Expected<AxisChannels> find_channels(const std::set<std::string>& names,
                                     const std::string& option) {
  std::set<std::string> beginnings;
  for (const std::string& name : names) {
    for (const char axis : axis_names) {
      if (name.ends_with(std::string("_") + axis)) {
        beginnings.insert(name.substr(0, name.size() - 1));
      }
    }
  }
  if (beginnings.size() != 1) {
    return fail(
        ErrorCode::bad_argument,
        fmt::format("the channels of the axes cannot be found by their names (_x, _y, _z at "
                    "the end); name them: {} X Y Z",
                    option));
  }
  const std::string& beginning = *beginnings.begin();
  return AxisChannels{beginning + "x", beginning + "y", beginning + "z"};
}

Expected<ResultPoints> read_points(const std::filesystem::path& path, char along,
                                   ByteCount& bytes) {
  DYNCAL_TRY(const auto result, read_values(path, bytes));
  ResultPoints points;
  for (const auto& [place, point] : means_of(result)) {
    if (place.axis.size() == 1 && place.axis.front() != along &&
        axis_names.find(place.axis) != std::string_view::npos) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{} was excited along {} (excitation.axis of its bench file), but is "
                              "given for {}",
                              path.string(), place.axis, along));
    }
    PointIdentity named = place;
    named.axis.clear();
    points.emplace(std::move(named), point);
  }
  return points;
}

} // namespace dyncal::inline programs
