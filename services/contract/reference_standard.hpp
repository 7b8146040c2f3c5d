// The reference of a bench as its certificates state it: the interferometer or the transducer and
// its amplifier, for documents. What nobody has stated is empty. Days are YYYY-MM-DD. Plain data;
// any thread.
#pragma once

#include <string>
#include <vector>

namespace dyncal::inline contract {

struct CalibratedDevice {
  std::string name;
  std::string manufacturer;
  std::string model;
  std::string serial;
  std::string certificate; // its number
  std::string issued_by;
  std::string issued;
  std::string valid_until; // the last day
};

struct ReferenceStandard {
  std::vector<CalibratedDevice> devices; // the transducer first; empty: not stated
  std::string standard;                  // ISO 16063-11 or ISO 16063-21
  std::string traceability;              // one sentence
  std::string file;                      // that says so; empty: the laboratory file
  std::string file_sha256;
};

} // namespace dyncal::inline contract
