// What all others need to know of a driver of an analogue calibration system (ACS): its word in a
// bench file, its own keys there, and how a source is made of them.
//
// A driver is a folder of its own, which has one such description, and a row of the table in
// services/bench/file/acs_drivers.cpp. The bench file, dyncal-acs, the checks and the guard take
// everything from there. text_stream/ is a small one to begin with.
//
// Immutable; any thread. make() fails with invalid_setting and a sentence that names the key.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/sample_source.hpp"

namespace dyncal::drivers {

struct AcsTextKey { // required
  const char* name;
  const char* meaning; // for the sentence where it is missing
};

struct AcsNumberKey {
  const char* name; // with its unit; "sample_rate_hz" is the rate that the device is set to
  const char* unit;
  std::optional<double> otherwise{}; // where the key is not there; nothing: it is required
};

// What a bench file says to one of its sources.
struct AcsKeys {
  std::map<std::string, std::string> texts{};
  std::map<std::string, double> numbers{};
  std::map<std::string, std::string> channels{}; // the device's name -> ours
  std::map<std::string, std::string> units{};    // our name -> D-SI
};

struct AcsDriver {
  const char* name; // driver = "..."
  std::vector<AcsTextKey> texts{};
  std::vector<AcsNumberKey> numbers{};
  Expected<std::unique_ptr<SampleSource>> (*make)(const AcsKeys& keys) = nullptr;
};

} // namespace dyncal::drivers
