#include "services/views/lab_file/sensor_file.hpp"

#include "services/base/whole_file.hpp"
#include "services/views/lab_file/table_file.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::uintmax_t max_file_bytes = 1U << 20U;

void read_sensor(TomlTable& root, SensorFile& file) {
  auto sensor = root.table("sensor");
  if (!sensor) {
    root.refuse("sensor",
                "is missing: the table [sensor] with name, manufacturer, model and serial");
    return;
  }
  file.name = required_line(*sensor, "name");
  file.manufacturer = required_line(*sensor, "manufacturer");
  file.model = required_line(*sensor, "model");
  file.serial = required_line(*sensor, "serial");
  file.electronic_model = line_of(*sensor, "electronic_model");
  file.electronic_serial = line_of(*sensor, "electronic_serial");
  file.firmware = line_of(*sensor, "firmware");
  file.owner_identification = line_of(*sensor, "owner_identification");
  if (sensor->has("interval_months")) {
    file.interval_months = sensor->whole_number("interval_months", 0, 1);
  }
  file.received = date_of(*sensor, "received");
  file.condition = line_of(*sensor, "condition");
  file.positive_direction = line_of(*sensor, "positive_direction");
  file.settings = sensor->text_map("settings");
  sensor->finish();
}

SensorFile read_tables(const toml::table& parsed, const std::filesystem::path& path,
                       BenchProblems& problems) {
  SensorFile file;
  file.path = path;
  TomlTable root(parsed, "", path.string(), problems);
  read_sensor(root, file);
  if (auto certificate = root.table("certificate")) {
    file.certificate_number = required_line(*certificate, "number");
    certificate->finish();
  }
  read_table(root, "customer", read_contact, file.customer);
  read_table(root, "conditions", read_conditions, file.conditions);
  file.tolerances = read_tolerances(root, path.string(), problems);
  root.finish();
  return file;
}

} // namespace

Expected<SensorFile> parse_sensor_file(std::string_view text, const std::filesystem::path& path) {
  return parse_tables(text, path, read_tables);
}

Expected<SensorFile> read_sensor_file(const std::filesystem::path& path) {
  DYNCAL_TRY(const auto text, read_whole_file(path, max_file_bytes));
  return parse_sensor_file(text, path);
}

} // namespace dyncal::inline views
