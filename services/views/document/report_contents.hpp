// What a report is made of: the stored result, and what laboratory and sensor files add to it.
#pragma once

#include <string>
#include <vector>

#include "services/views/lab_file/embedded_picture.hpp"
#include "services/views/lab_file/laboratory_file.hpp"
#include "services/views/lab_file/sensor_file.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct ReportContents {
  StoredResult result;
  std::optional<LaboratoryFile> laboratory;
  std::optional<SensorFile> sensor;
  std::vector<std::string> channels;     // those whose values are shown in full
  std::vector<EmbeddedPicture> pictures; // further figures of the run folder
  std::vector<std::string> left_out;     // pictures that could not be taken in, and why
  std::string issued;                    // YYYY-MM-DD
  std::string software;                  // that makes the report
};

} // namespace dyncal::inline views
