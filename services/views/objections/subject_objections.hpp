// What speaks against a document because of whom and what it names: another sensor than the run was
// measured with, a receipt after the measurement, a reference that was not yet calibrated, or not
// any more, on the day of it.
//
// A sensor is the one of the run if serial number and model are those that its source states,
// letters and digits alone compared, for "MPU 9250" is MPU-9250; a source that states no serial
// number does not know its sensor, and contradicts nothing. An amendment of the run says otherwise
// than the source, and counts. Where a sensor calls itself otherwise
// than it is labelled, its file says how. The reference is that of the run's reference file, else
// that of the laboratory file; where both state one, they must be the same. Days are those of UTC,
// or of this computer's zone if that favours the document. Any thread.
#pragma once

#include <string>
#include <vector>

#include "services/contract/reference_standard.hpp"
#include "services/views/lab_file/laboratory_file.hpp"
#include "services/views/lab_file/sensor_file.hpp"
#include "services/views/language/sentence.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct DocumentSubject {
  const StoredResult& result;
  std::vector<std::string> channels;
  const SensorFile& sensor;
  const LaboratoryFile& laboratory;
  const ReferenceStandard& reference;
  std::string began; // of the measurement, YYYY-MM-DD
  std::string ended;
};

// What the results are traceable to: as the run states it, else the laboratory file; null: neither.
[[nodiscard]] const ReferenceStandard* reference_of(const StoredResult& result,
                                                    const LaboratoryFile* laboratory);

// Fails (bad_file) naming what is lacking of what every document states: who is responsible, what
// the results are traceable to, and by which standard.
[[nodiscard]] Expected<ReferenceStandard> documented_reference(const StoredResult& result,
                                                               const LaboratoryFile& laboratory);

// A sentence for each.
[[nodiscard]] std::vector<TranslatedText> objections_to_subject(const DocumentSubject& subject);

} // namespace dyncal::inline views
