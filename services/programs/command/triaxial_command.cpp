// `dyncal triaxial --x X.json --y Y.json --z Z.json`: the response of a sensor's three axes from
// one result for each direction of excitation, and its transverse sensitivity
// (analysis/response/triaxial.hpp).
//
// The result of an excitation along j holds the transfer functions of the sensor's three channels
// against the reference along j: column j of the 3x3 response. Any one direction is enough for its
// column; transverse motion is then assumed to be zero, and its bound (--transverse-motion) goes
// into the uncertainty. With a triaxial reference the transverse motion is known: --motion-x, -y,
// -z name a result each (method analogue) of the other two axes of the reference against the
// excited one, from the same records; they need all three directions. Points are those of a
// frequency and level that all files have; a file that states another excited axis than its option
// is refused. A channel is found by the end of its name (_x, _y, _z) or named with --channels,
// --motion-channels.
//
// Prints a table, or JSON. Exit status not 0 and one line when a file is not a result, a channel is
// missing or nothing is in common. Belongs to one thread.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "analysis/response/triaxial.hpp"
#include "services/programs/command/axis_results.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/triaxial_lines.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/report/result_file.hpp"

namespace dyncal::inline programs {
namespace {

struct TriaxialOptions {
  std::array<std::filesystem::path, 3> results; // by direction of excitation; empty: not measured
  std::array<std::filesystem::path, 3>
      motions;                              // of a triaxial reference; empty: single-axis reference
  std::vector<std::string> channels;        // of the sensor: x, y, z; empty: found
  std::vector<std::string> motion_channels; // of the reference: x, y, z; empty: found
  double transverse_motion_rel = 0.0;       // bound of the motion across a single-axis reference
  bool json = false;
};

void add_triaxial(CLI::App& command, TriaxialOptions& triaxial) {
  constexpr std::array axes{"x", "y", "z"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    command.add_option(std::string("--") + axes[i], triaxial.results[i],
                       std::string("result of the excitation along ") + axes[i]);
    command.add_option(
        std::string("--motion-") + axes[i], triaxial.motions[i],
        std::string("result of a triaxial reference's other axes against its axis ") + axes[i]);
  }
  command
      .add_option(
          "--channels", triaxial.channels,
          "channels of the sensor: x, y, z (default: those whose names end with _x, _y, _z)")
      ->expected(3);
  command
      .add_option(
          "--motion-channels", triaxial.motion_channels,
          "channels of the reference: x, y, z (default: those whose names end with _x, _y, _z)")
      ->expected(3);
  add_checked(command, "--transverse-motion", triaxial.transverse_motion_rel,
              "bound of the exciter's transverse motion, relative to that along its axis",
              CLI::NonNegativeNumber);
  command.add_flag("--json", triaxial.json, "print JSON");
}

using Names = AxisChannels;

struct Direction { // one excitation
  std::size_t axis = 0;
  ResultPoints sensor;
  ResultPoints motion; // empty: single-axis reference
};

struct Measured {
  Names channels;
  Names motion_channels;
  std::vector<Direction> directions;
  [[nodiscard]] bool triaxial_reference() const { return !directions.front().motion.empty(); }
};

tl::unexpected<Error> bad(std::string message) {
  return fail(ErrorCode::bad_argument, std::move(message));
}

Expected<Names> channels_of(const std::vector<std::string>& named,
                            const std::vector<Direction>& directions,
                            ResultPoints Direction::*points, const std::string& option) {
  if (named.size() == 3) {
    return Names{named[0], named[1], named[2]};
  }
  // A sensor may have other axes than those that answer in the reference's unit: a gyroscope's, a
  // magnetometer's.
  std::set<std::string> like_the_reference;
  std::set<std::string> others;
  for (const Direction& direction : directions) {
    for (const auto& [place, point] : direction.*points) {
      (point.unit == R"(\one)" ? like_the_reference : others).insert(place.channel);
    }
  }
  return find_channels(like_the_reference.empty() ? others : like_the_reference, option);
}

Expected<Measured> read(const TriaxialOptions& command, const SharedWorkCount& count) {
  ByteCount bytes(count, "reading",
                  bytes_of_files(command.results) + bytes_of_files(command.motions));
  Measured measured;
  const bool motion_known = std::any_of(command.motions.begin(), command.motions.end(),
                                        [](const auto& path) { return !path.empty(); });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (motion_known && (command.results[axis].empty() || command.motions[axis].empty())) {
      return bad("a triaxial reference needs the results and the motions of all three directions: "
                 "--x --y --z --motion-x --motion-y --motion-z");
    }
    if (command.results[axis].empty()) {
      continue;
    }
    DYNCAL_TRY(auto sensor, read_points(command.results[axis], axis_names[axis], bytes));
    measured.directions.push_back({axis, std::move(sensor), {}});
    if (motion_known) {
      DYNCAL_TRY(auto motion, read_points(command.motions[axis], axis_names[axis], bytes));
      measured.directions.back().motion = std::move(motion);
    }
  }
  if (measured.directions.empty()) {
    return bad("give the result of at least one direction of excitation: --x, --y or --z");
  }
  auto channels =
      channels_of(command.channels, measured.directions, &Direction::sensor, "--channels");
  DYNCAL_TRY(channels);
  measured.channels = std::move(*channels);
  if (motion_known) {
    channels = channels_of(command.motion_channels, measured.directions, &Direction::motion,
                           "--motion-channels");
    DYNCAL_TRY(channels);
    measured.motion_channels = std::move(*channels);
  }
  return measured;
}

struct AxesAndUncertainty {
  analysis::Axes values{};
  std::array<double, 3> u{}; // of each real component: the larger of along and across the phasor
};

// Nothing when a channel has no value there. The excited axis of a reference is the unit of its
// motion.
std::optional<AxesAndUncertainty> axes_at(const ResultPoints& points, const Names& channels,
                                          PointIdentity place,
                                          std::optional<std::size_t> unit_axis) {
  AxesAndUncertainty axes;
  for (std::size_t i = 0; i < 3; ++i) {
    if (unit_axis == i) {
      axes.values[i] = 1.0;
      continue;
    }
    place.channel = channels[i];
    const auto found = points.find(place);
    if (found == points.end()) {
      return std::nullopt;
    }
    const analysis::ComparedResult& value = found->second.value;
    axes.values[i] = std::polar(value.magnitude, value.phase_rad);
    axes.u[i] =
        0.5 * std::max(value.of_magnitude.expanded(), value.magnitude * value.of_phase.expanded());
  }
  return axes;
}

// Nothing when not all directions have the frequency at this level.
Expected<std::optional<ResponsePoint>> response_at(const Measured& measured,
                                                   const PointIdentity& place) {
  ResponsePoint point{.frequency_hz = place.frequency_hz,
                      .level_m_s2 = place.level_m_s2,
                      .columns = {},
                      .transverse = {},
                      .largest = {}};
  std::vector<analysis::TriaxialExcitation> excitations;
  for (const Direction& direction : measured.directions) {
    const auto sensor = axes_at(direction.sensor, measured.channels, place, std::nullopt);
    if (!sensor) {
      return std::optional<ResponsePoint>();
    }
    point.columns[direction.axis] = sensor->values;
    point.u[direction.axis] = sensor->u;
    if (measured.triaxial_reference()) {
      const auto motion =
          axes_at(direction.motion, measured.motion_channels, place, direction.axis);
      if (!motion) {
        return std::optional<ResponsePoint>();
      }
      excitations.push_back({motion->values, motion->u, sensor->values, sensor->u});
    }
  }
  if (!measured.triaxial_reference()) {
    return std::optional(point);
  }
  const auto response = analysis::evaluate_triaxial(excitations);
  if (!response) {
    return fail(ErrorCode::no_result,
                fmt::format("{}: {}", place_text(place), response.error().message));
  }
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      (*point.columns[j])[i] = response->h[i][j];
      point.u[j][i] = response->u[i][j];
    }
  }
  return std::optional(point);
}

// Of an axis, where its answers to both directions across it are known. One that was not excited
// itself is taken to answer as much as another.
std::optional<analysis::LargestTransverse> largest_of(const ResponsePoint& point, std::size_t axis,
                                                      double transverse_motion_rel) {
  const std::size_t first = axis == 0 ? 1 : 0;
  const std::size_t second = axis == 2 ? 1 : 2;
  if (!point.columns[first] || !point.columns[second]) {
    return std::nullopt;
  }
  const double along =
      std::abs(point.columns[axis] ? (*point.columns[axis])[axis] : (*point.columns[first])[first]);
  const double unknown = transverse_motion_rel * along / std::sqrt(3.0);
  const auto answer = [&](std::size_t direction) {
    return analysis::TransverseAnswer{(*point.columns[direction])[axis],
                                      std::hypot(point.u[direction][axis], unknown)};
  };
  return analysis::largest_transverse(answer(first), answer(second), along);
}

Expected<void> add_transverse(ResponsePoint& point, double transverse_motion_rel) {
  for (std::size_t j = 0; j < 3; ++j) {
    if (!point.columns[j]) {
      continue;
    }
    std::array<double, 3> own{};
    for (std::size_t i = 0; i < 3;
         ++i) { // an axis that was not excited answers about as much as the others
      own[i] = std::abs(point.columns[i] ? (*point.columns[i])[i] : (*point.columns[j])[j]);
    }
    const auto transverse = analysis::transverse_sensitivity(*point.columns[j], point.u[j], j, own,
                                                             transverse_motion_rel);
    if (!transverse) {
      return fail(ErrorCode::no_result,
                  fmt::format("{} Hz, excitation along {}: {}", point.frequency_hz, axis_names[j],
                              transverse.error().message));
    }
    point.transverse[j] = *transverse;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    point.largest[i] = largest_of(point, i, transverse_motion_rel);
  }
  return {};
}

Expected<std::vector<ResponsePoint>> evaluate(const TriaxialOptions& command,
                                              const Measured& measured, WorkCount& count) {
  std::vector<ResponsePoint> points;
  count.begin("evaluating", "values", measured.directions.front().sensor.size());
  for (const auto& [place, unused] : measured.directions.front().sensor) {
    count.add_done();
    if (place.channel != measured.channels[0]) {
      continue;
    }
    DYNCAL_TRY(auto point, response_at(measured, place));
    if (!point) {
      continue;
    }
    const double bound = measured.triaxial_reference() ? 0.0 : command.transverse_motion_rel;
    DYNCAL_TRY(add_transverse(*point, bound));
    points.push_back(*point);
  }
  if (points.empty()) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("the files have no frequency and level in common at which {}, {} and {} "
                    "have values",
                    measured.channels[0], measured.channels[1], measured.channels[2]));
  }
  return points;
}

// The progress is gone before anything is printed.
Expected<std::pair<Measured, std::vector<ResponsePoint>>>
read_and_evaluate(const TriaxialOptions& command) {
  const WorkProgress progress("reading");
  DYNCAL_TRY(auto measured, read(command, progress.count()));
  DYNCAL_TRY(auto points, evaluate(command, measured, *progress.count()));
  return std::pair(std::move(measured), std::move(points));
}

Expected<void> run_triaxial(const TriaxialOptions& command) {
  DYNCAL_TRY(const auto evaluated, read_and_evaluate(command));
  const auto& [measured, points] = evaluated;
  const TriaxialText text{measured.channels, measured.triaxial_reference(), points};
  command.json ? print_json(text) : print_table(text, command.transverse_motion_rel);
  return {};
}

const Command triaxial_command{
    200, "triaxial",
    "response of a sensor's three axes and transverse sensitivity, from one result for each "
    "direction of excitation",
    add_triaxial, run_triaxial};

} // namespace
} // namespace dyncal::inline programs
