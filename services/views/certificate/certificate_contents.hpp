// What a certificate states, gathered from the stored result, the laboratory file and the sensor
// file, and checked: nothing that a certificate needs may be missing.
//
// Fails (bad_file) naming the missing table or key and its file; (bad_argument) for a channel
// without values, and for a day that is not that of the run; (no_result) when something speaks
// against the certificate (objections.hpp) and it is not forced. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/views/conformity/conformity.hpp"
#include "services/views/lab_file/laboratory_file.hpp"
#include "services/views/lab_file/sensor_file.hpp"
#include "services/views/language/sentence.hpp"
#include "services/views/objections/held_result.hpp"

namespace dyncal::inline views {

struct CertificateRequest {
  HeldResult held;           // that is certified
  std::filesystem::path run; // its folder or file
  std::filesystem::path laboratory;
  std::optional<SensorFile> sensor{}; // nothing: as the run's source describes itself
  std::filesystem::path tolerances;   // empty: those of the sensor file, if any
  std::vector<std::string> channels;  // empty: all that respond
  std::string number;                 // empty: that of the sensor file, if any
  std::string performed;              // YYYY-MM-DD, of a run that does not know it
  std::string replaces;            // number of the certificate whose place it takes; may be empty
  std::string replaced_identifier; // UUID of that one; empty: not known
  std::string replaced_sha256;     // of its file; empty: not known
  std::vector<Language> languages; // empty: as the laboratory file says
  bool force = false;
};

struct CertifiedChannel {
  std::string channel;
  std::string unit; // D-SI
  std::vector<StoredValue> values;
};

struct CertificateContents {
  StoredResult result;
  LaboratoryFile laboratory;
  ReferenceStandard reference;
  SensorFile sensor;
  Contact customer;
  Conditions conditions;
  std::vector<TranslatedText> condition_origins; // sentences
  std::vector<CertifiedChannel> channels;
  std::optional<ConformityReport> conformity; // nothing: no tolerances
  std::string number;                         // may be empty
  std::string replaces;                       // likewise
  std::string replaced_identifier;
  std::string replaced_sha256;
  std::vector<Language> languages{Language::english}; // the first is the mandatory one
  std::vector<TranslatedText> provenance;             // what the result was held against
  std::string identifier;                             // a new UUID
  std::string began;                                  // YYYY-MM-DD
  std::string ended;
  std::string issued;
  std::string software;
  std::string recording_sha256;           // empty: no recording in the run folder
  std::vector<TranslatedText> objections; // in spite of which it is issued
  std::vector<TranslatedText> flags;      // that are stated beside the values
  bool has_monte_carlo = false;           // a check for every value
};

[[nodiscard]] Expected<CertificateContents> gather_certificate(const CertificateRequest& request);

// Channels with their unit in D-SI and the values that can be stated. Fails (bad_file) for a unit
// that is not known.
[[nodiscard]] Expected<std::vector<CertifiedChannel>>
certified_channels(const StoredResult& result, const std::vector<std::string>& channels);

} // namespace dyncal::inline views
