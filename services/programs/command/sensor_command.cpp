// `dyncal sensor add | import | list | show`: the sensors of a laboratory, by serial number, in the
// store of all results (services/records/store/sensor_library.hpp). Belongs to one thread.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/acting_person.hpp"
#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/base/whole_file.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/records/store/document_register.hpp"
#include "services/records/store/sensor_library.hpp"
#include "services/records/store/store.hpp"
#include "services/views/lab_file/sensor_list.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t max_file_bytes = 1U << 20U;

struct SensorAddOptions {
  StorePlace store;
  std::vector<std::filesystem::path> files;
  bool change = false;
};

void add_files(CLI::App& command, SensorAddOptions& options, const char* name, const char* what) {
  command.add_option(name, options.files, what)->required();
  command.add_flag("--change", options.change,
                   "take it in place of what the library has of the same serial number");
  add_store_place(command, options.store);
}

void add_sensor_add(CLI::App& command, SensorAddOptions& options) {
  add_files(command, options, "SENSOR.toml", "sensor file, repeatable");
}

void add_sensor_import(CLI::App& command, SensorAddOptions& options) {
  add_files(command, options, "LIST.csv",
            "CSV with a head: serial, name, manufacturer, model, and what else there is");
}

const char* addition_text(SensorAddition addition) {
  switch (addition) {
  case SensorAddition::added:
    return "added";
  case SensorAddition::already_there:
    return "already there";
  case SensorAddition::changed:
    break;
  }
  return "changed";
}

// All of them or none.
Expected<void> keep(const SensorAddOptions& options, const std::vector<SensorText>& sensors) {
  DYNCAL_TRY(auto library, SensorLibrary::open(options.store.text()));
  DYNCAL_TRY(const auto additions, library->add(sensors, options.change, acting_person()));
  for (std::size_t i = 0; i < additions.size(); ++i) {
    DYNCAL_TRY(const auto sensor, parse_sensor_file(sensors[i].text, sensors[i].path));
    fmt::print("{}: {}\n", one_line(sensor.serial), addition_text(additions[i]));
  }
  return {};
}

Expected<void> run_sensor_add(const SensorAddOptions& options, const std::stop_token& /*stop*/) {
  std::vector<SensorText> sensors;
  for (const std::filesystem::path& file : options.files) {
    DYNCAL_TRY(auto text, read_whole_file(file, max_file_bytes));
    sensors.push_back({std::move(text), file});
  }
  return keep(options, sensors);
}

Expected<void> run_sensor_import(const SensorAddOptions& options, const std::stop_token& /*stop*/) {
  std::vector<SensorText> sensors;
  for (const std::filesystem::path& file : options.files) {
    DYNCAL_TRY(const auto list, read_whole_file(file, max_file_bytes));
    DYNCAL_TRY(const auto texts, parse_sensor_list(list, file));
    for (const std::string& text : texts) {
      sensors.push_back({text, file});
    }
  }
  return keep(options, sensors);
}

struct SensorListOptions {
  StorePlace store;
  bool json = false;
};

void add_sensor_list(CLI::App& command, SensorListOptions& options) {
  command.add_flag("--json", options.json, "print JSON");
  add_store_place(command, options.store);
}

Json json_of(const LibrarySensor& one) {
  const SensorFile& sensor = one.sensor;
  return {
      {"serial", sensor.serial},
      {"name", sensor.name},
      {"manufacturer", sensor.manufacturer},
      {"model", sensor.model},
      {"owner", sensor.customer ? Json(sensor.customer->name) : Json(nullptr)},
      {"interval_months", sensor.interval_months ? Json(*sensor.interval_months) : Json(nullptr)},
      {"has_tolerances", sensor.tolerances.has_value()},
      {"settings", sensor.settings},
      {"version", one.version},
      {"since_utc", one.added_utc}};
}

std::string interval_text(const SensorFile& sensor) {
  return sensor.interval_months ? fmt::format("{} months", *sensor.interval_months) : "";
}

Expected<int> run_sensor_list(const SensorListOptions& options) {
  DYNCAL_TRY(auto library, SensorLibrary::open(options.store.text()));
  DYNCAL_TRY(const auto sensors, library->all());
  if (options.json) {
    Json json = Json::array();
    for (const LibrarySensor& one : sensors) {
      json.push_back(json_of(one));
    }
    fmt::print("{}\n", json_text(json, 2));
    return 0;
  }
  for (const LibrarySensor& one : sensors) {
    const SensorFile& sensor = one.sensor;
    fmt::print("{:<20} {:<32} {:<24} {}\n", one_line(sensor.serial),
               one_line(sensor.manufacturer + " " + sensor.model),
               one_line(sensor.customer ? sensor.customer->name : ""), interval_text(sensor));
  }
  fmt::print("{} sensors\n", sensors.size());
  return 0;
}

struct SensorShowOptions {
  StorePlace store;
  std::string serial;
  bool file = false;
};

void add_sensor_show(CLI::App& command, SensorShowOptions& options) {
  command.add_option("SERIAL", options.serial, "serial number")->required();
  command.add_flag("--file", options.file, "print its sensor file, to be changed and added again");
  add_store_place(command, options.store);
}

void print_sensor(const LibrarySensor& one, int versions) {
  const SensorFile& sensor = one.sensor;
  const auto line = [](const char* what, const std::string& text) {
    if (!text.empty()) {
      fmt::print("  {:<12} {}\n", what, one_line(text));
    }
  };
  fmt::print("{}: {}, {} {}\n", one_line(sensor.serial), one_line(sensor.name),
             one_line(sensor.manufacturer), one_line(sensor.model));
  line("owner", sensor.customer ? sensor.customer->name : "");
  line("their number", sensor.owner_identification);
  line("firmware", sensor.firmware);
  for (const auto& [name, value] : sensor.settings) {
    line(name.c_str(), value);
  }
  line("tolerances", sensor.tolerances ? sensor.tolerances->specification : "");
  line("interval", interval_text(sensor));
  line("file since", fmt::format("{}, version {} of {}", one.added_utc, one.version, versions));
}

// Runs of sensors that call themselves by another number are found by that.
Expected<void> print_history(const std::string& place, const SensorFile& sensor) {
  DYNCAL_TRY(auto store, Store::open(place));
  for (const std::string& serial : {sensor.serial, sensor.electronic_serial}) {
    DYNCAL_TRY(const auto runs, store->runs({.sensor = serial.empty() ? "\n" : serial}));
    for (const StoredRun& run : runs) {
      fmt::print("  {:<12} {}, bench {}, run {}, {}\n", "measured",
                 one_line(run.began_utc.substr(0, 10)), one_line(run.bench), one_line(run.run),
                 one_line(run.state));
    }
  }
  DYNCAL_TRY(auto documents, DocumentRegister::open(place));
  DYNCAL_TRY(const auto issued, documents->of_sensor(sensor.serial));
  for (const IssuedDocument& document : issued) {
    fmt::print("  {:<12} {}, {} number {}{}\n", "issued",
               one_line(document.issued_utc.substr(0, 10)), one_line(document.kind),
               one_line(document.number),
               document.replaces.empty() ? "" : ", replaces " + one_line(document.replaces));
  }
  return {};
}

Expected<int> run_sensor_show(const SensorShowOptions& options) {
  const std::string place = options.store.text();
  DYNCAL_TRY(auto library, SensorLibrary::open(place));
  DYNCAL_TRY(const auto versions, library->versions(options.serial));
  if (versions.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("the library of {} has no sensor '{}'; 'dyncal sensor list' shows them",
                            without_password(place), options.serial));
  }
  if (options.file) {
    fmt::print("{}", versions.back().text);
    return 0;
  }
  print_sensor(versions.back(), static_cast<int>(versions.size()));
  DYNCAL_TRY(print_history(place, versions.back().sensor));
  return 0;
}

const Command sensor_command{85, "sensor", "the sensors of the laboratory, by serial number"};
const Command sensor_add_command{86, "sensor add", "add sensor files to the library",
                                 add_sensor_add, run_sensor_add};
const Command sensor_import_command{87, "sensor import", "add the sensors of a list (CSV)",
                                    add_sensor_import, run_sensor_import};
const Command sensor_list_command{88, "sensor list", "the sensors of the library", add_sensor_list,
                                  run_sensor_list};
const Command sensor_show_command{89, "sensor show", "one sensor: file, runs and documents",
                                  add_sensor_show, run_sensor_show};

} // namespace
} // namespace dyncal::inline programs
