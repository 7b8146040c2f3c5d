// What a bench file says of one source, as text that programs can compare: the service that
// publishes the source and the run that reads it may have read two files.
//
// Of a difference only what concerns the source matters: its table, not the steps of the run. The
// text has one line "key = value" for every key, in alphabetical order; keys of inner tables are
// written with a dot, numbers as numbers whatever their notation. Plain functions, any thread.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace dyncal::inline contract {

struct BenchFileOrigin {
  std::string sha256;   // of the whole file, in hexadecimal
  std::string settings; // of the source
};

// The first key whose values differ; a key that only one of them has stands with an empty value
// against that of the other.
struct SettingsDifference {
  std::string key;
  std::string service_value;
  std::string run_value;
};

// Nothing if they agree, or if either is empty: not known.
[[nodiscard]] std::optional<SettingsDifference> settings_difference(const std::string& of_service,
                                                                    const std::string& of_run);

// The same for a source by its name, with the settings that the run has for each.
[[nodiscard]] std::optional<SettingsDifference>
settings_difference(const std::string& of_service, const std::map<std::string, std::string>& of_run,
                    const std::string& source);

// One sentence about a difference, and what to do about it.
[[nodiscard]] std::string refusal(const SettingsDifference& difference, const std::string& bench,
                                  const std::string& source, const std::string& host);

} // namespace dyncal::inline contract
