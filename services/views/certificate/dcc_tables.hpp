// The tables of responses over frequency in a digital calibration certificate (DCC 3.x) of any
// laboratory: lists of one length with a frequency and a magnitude.
//
// Quantities are known by their refType (vibration_frequency, vibration_magnitude...,
// vibration_phase, vibration_accelerationAmplitude), else by their unit (D-SI). Lists may be those
// of D-SI 2 (realListXMLList with expandedMUXMLList, standardMUXMLList, or expandedUncXMLList
// before 2.2) or single si:real. Texts of numbers are kept as they stand. Plain functions; any
// thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/views/certificate/xml_document.hpp"

namespace dyncal::inline views {

// One text a point; of the last two none where nothing is stated.
struct DccColumn {
  std::string unit; // D-SI
  std::vector<std::string> values;
  std::vector<std::string> uncertainties;
  std::vector<std::string> coverage_factors; // none of standard uncertainties
};

struct DccTable {
  std::string name; // of the table, else of its result; each once
  DccColumn frequency;
  DccColumn magnitude;
  std::optional<DccColumn> phase;
  std::optional<DccColumn> level;
  std::vector<std::string> comments; // on single points: "at 8.0e+03 Hz: ..."
};

[[nodiscard]] std::vector<DccTable> response_tables(const XmlElement& certificate);

// The text of an element with dcc:content in several languages: English, else the first.
[[nodiscard]] std::string english_text(const XmlElement& element);

} // namespace dyncal::inline views
