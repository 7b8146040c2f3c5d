#include "services/programs/command/named_sensor.hpp"

#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <toml++/toml.h>

#include "services/bench/file/toml_lines.hpp"
#include "services/bench/file/toml_text.hpp"
#include "services/records/store/sensor_library.hpp"

namespace dyncal::inline programs {
namespace {

// The key `sensor` of a bench file, which was read when the run began.
std::string named_by_bench_file(const std::string& recipe) {
  const auto parsed = parse_toml(recipe, "recipe");
  return parsed ? (*parsed)["sensor"].value_or(std::string()) : "";
}

} // namespace

CLI::Option* add_sensor_option(CLI::App& command, std::string& sensor) {
  return command.add_option("--sensor", sensor,
                            "sensor file, or serial number of a sensor in the library (default: "
                            "the 'sensor' of the bench file)");
}

void add_sensor_options(CLI::App& command, SensorOptions& options) {
  add_sensor_option(command, options.sensor);
  command
      .add_option("--received", options.received,
                  "day on which the sensor came, YYYY-MM-DD (default: that of the sensor file)")
      ->check(CLI::Validator(
          [](const std::string& text) { return is_date(text) ? std::string() : date_rule(text); },
          "DATE"));
  command.add_option("--condition", options.condition,
                     "in which the sensor came (default: that of the sensor file)");
}

Expected<SensorFile> sensor_named(const std::string& sensor, const std::string& place) {
  std::error_code unknown;
  if (std::filesystem::exists(sensor, unknown) || sensor.ends_with(".toml")) {
    return read_sensor_file(sensor);
  }
  DYNCAL_TRY(auto library, SensorLibrary::open(place));
  DYNCAL_TRY(auto known, library->find(sensor));
  if (!known) {
    return fail(ErrorCode::bad_argument,
                fmt::format("'{}' is neither a sensor file nor a sensor of the library of {}; "
                            "'dyncal sensor list' shows them, 'dyncal sensor add SENSOR.toml' adds "
                            "one",
                            sensor, without_password(place)));
  }
  return std::move(known->sensor);
}

Expected<std::optional<SensorFile>>
sensor_of_run(const SensorOptions& options, const StoredResult& result, const std::string& place) {
  std::string named = options.sensor.empty() ? result.sensor : options.sensor;
  named = named.empty() ? named_by_bench_file(result.recipe) : named;
  if (named.empty()) {
    if (!options.received.empty() || !options.condition.empty()) {
      return fail(ErrorCode::bad_argument,
                  "--received and --condition are of a sensor; name it with --sensor");
    }
    return std::nullopt;
  }
  DYNCAL_TRY(auto sensor, sensor_named(named, place));
  if (!options.received.empty()) {
    sensor.received = options.received;
  }
  if (!options.condition.empty()) {
    sensor.condition = options.condition;
  }
  return sensor;
}

} // namespace dyncal::inline programs
