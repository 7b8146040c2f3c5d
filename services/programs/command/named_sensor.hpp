// The sensor that a document is about: a sensor file, or a sensor of the library by its serial
// number (services/records/store/sensor_library.hpp), and what only this calibration has of it. One
// thread.
#pragma once

#include <optional>
#include <string>

#include "services/base/error.hpp"
#include "services/views/lab_file/sensor_file.hpp"
#include "services/views/report/stored_result.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
class Option;
} // namespace CLI

namespace dyncal::inline programs {

struct SensorOptions {
  std::string sensor;    // a file or a serial number; empty: that of the bench file, if any
  std::string received;  // YYYY-MM-DD; empty: as the sensor file says
  std::string condition; // as it came; likewise
};

// --sensor, --received, --condition
void add_sensor_options(CLI::App& command, SensorOptions& options);
// --sensor alone
CLI::Option* add_sensor_option(CLI::App& command, std::string& sensor);

// A file of that name, else the sensor of that serial number in the library at `place`. Fails
// (bad_argument) where there is neither.
[[nodiscard]] Expected<SensorFile> sensor_named(const std::string& sensor,
                                                const std::string& place);

// As the options say, else as the run was told, else the one that its bench file names (`sensor`);
// nothing: no one names any.
[[nodiscard]] Expected<std::optional<SensorFile>>
sensor_of_run(const SensorOptions& options, const StoredResult& result, const std::string& place);

} // namespace dyncal::inline programs
