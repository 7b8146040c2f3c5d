// What is to be calibrated: the sensors of the library whose interval since their last certificate
// is over, and references and equipment whose certificate ends.
//
//   sensor      due `interval_months` after the day on which the run of its newest document ended;
//               without a document it was never calibrated here, and is due
//   reference   of the newest result of each bench: the day until which its certificate is valid
//   equipment   likewise, of a laboratory file
//
// Sensors without an interval and devices without such a day are not listed. Days are YYYY-MM-DD.
// Fails (bad_file) as databases do. Belongs to one thread.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "services/base/error.hpp"
#include "services/contract/reference_standard.hpp"
#include "services/records/store/database.hpp"

namespace dyncal::inline records {

struct CalibrationDate {
  std::string what; // "sensor", "reference", "equipment"
  std::string name;
  std::string serial;
  std::string owner{};       // of a sensor: its customer
  std::string last{};        // day of the last calibration; empty: not known, or never
  std::string certificate{}; // its number
  std::string due{};         // the last day that is covered; empty: never calibrated

  // On the day after `due`, and whenever it never was.
  [[nodiscard]] bool is_due_by(const std::string& day) const { return due < day; }
};

[[nodiscard]] Expected<std::vector<CalibrationDate>> calibration_dates(const std::string& place);

// Of devices that are valid until a stated day.
[[nodiscard]] std::vector<CalibrationDate>
dates_of_devices(const std::vector<CalibratedDevice>& devices, const std::string& what);

// Of the same device that is named several times the one that is due last; the earliest first.
[[nodiscard]] std::vector<CalibrationDate> newest_of_each(std::vector<CalibrationDate> dates);

// What the page and `dyncal due --json` show.
[[nodiscard]] nlohmann::ordered_json
calibration_dates_json(const std::vector<CalibrationDate>& dates, const std::string& today);

} // namespace dyncal::inline records
