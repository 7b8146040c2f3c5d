// The sensors of a laboratory: the sensor file of each, by serial number, as it stands now and as
// it stood before.
//
// What belongs to one calibration alone ([certificate], `received`, `condition`, `[conditions]`)
// is refused: it would be printed again in the next certificate. Nothing is ever removed: a changed
// file is another version of the sensor, and the newest one counts.
//
// Fails (bad_file) as sensor files and databases do, (bad_argument) where a sensor is there already
// with another file. Belongs to one thread; programs that write at once wait for each other.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "services/base/acting_person.hpp"
#include "services/base/error.hpp"
#include "services/records/store/database.hpp"
#include "services/views/lab_file/sensor_file.hpp"

namespace dyncal::inline records {

struct LibrarySensor {
  SensorFile sensor; // its path names library and serial number
  int version = 1;
  std::string added_utc;
  std::string text; // of the file
};

enum class SensorAddition { added, already_there, changed };

struct SensorText { // a sensor file, before it is read
  std::string text;
  std::filesystem::path path; // for messages
};

class SensorLibrary {
public:
  // In the database of a store; makes it if there is none.
  [[nodiscard]] static Expected<std::unique_ptr<SensorLibrary>> open(const std::string& place);

  // All of them or none. A sensor that is there with another file is changed only if that is asked
  // for. `by`: for the audit trail.
  [[nodiscard]] Expected<std::vector<SensorAddition>>
  add(const std::vector<SensorText>& sensors, bool may_change, const ActingPerson& by = {});
  // Nothing: none has this serial number.
  [[nodiscard]] Expected<std::optional<LibrarySensor>> find(const std::string& serial);
  // The newest version of each, by serial number.
  [[nodiscard]] Expected<std::vector<LibrarySensor>> all();
  // Of one sensor, the oldest first.
  [[nodiscard]] Expected<std::vector<LibrarySensor>> versions(const std::string& serial);

private:
  explicit SensorLibrary(std::unique_ptr<Database> database, std::string place)
      : database_(std::move(database)), place_(std::move(place)) {}
  Expected<SensorAddition> add_one(const SensorText& added, bool may_change,
                                   const ActingPerson& by);
  Expected<LibrarySensor> sensor_of(const DatabaseRow& row) const;
  Expected<std::vector<LibrarySensor>> sensors_of(const std::vector<DatabaseRow>& rows) const;

  std::unique_ptr<Database> database_;
  std::string place_; // for messages
};

} // namespace dyncal::inline records
