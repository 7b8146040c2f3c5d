#include "services/contract/bench_file_origin.hpp"

#include <map>
#include <sstream>

#include <fmt/core.h>

namespace dyncal::inline contract {
namespace {

std::map<std::string, std::string> values_by_key(const std::string& settings) {
  constexpr const char* separator = " = ";
  std::map<std::string, std::string> values;
  std::istringstream lines(settings);
  for (std::string line; std::getline(lines, line);) {
    const auto end_of_key = line.find(separator);
    if (end_of_key != std::string::npos) {
      values.emplace(line.substr(0, end_of_key), line.substr(end_of_key + 3));
    }
  }
  return values;
}

std::string value_phrase(const std::string& value) {
  return value.empty() ? "nothing" : value;
}

} // namespace

std::optional<SettingsDifference> settings_difference(const std::string& of_service,
                                                      const std::string& of_run) {
  if (of_service.empty() || of_run.empty() || of_service == of_run) {
    return std::nullopt;
  }
  const auto service_values = values_by_key(of_service);
  auto keys = values_by_key(of_run);
  keys.insert(service_values.begin(), service_values.end());
  const auto run_values = values_by_key(of_run);
  const auto value_in = [](const auto& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? std::string() : found->second;
  };
  for (const auto& [key, value] : keys) {
    SettingsDifference difference{key, value_in(service_values, key), value_in(run_values, key)};
    if (difference.service_value != difference.run_value) {
      return difference;
    }
  }
  return std::nullopt;
}

std::optional<SettingsDifference>
settings_difference(const std::string& of_service, const std::map<std::string, std::string>& of_run,
                    const std::string& source) {
  const auto found = of_run.find(source);
  return found == of_run.end() ? std::nullopt : settings_difference(of_service, found->second);
}

std::string refusal(const SettingsDifference& difference, const std::string& bench,
                    const std::string& source, const std::string& host) {
  return fmt::format("the service of source '{}' of bench '{}'{} has read another bench file than "
                     "this run: key 'sources.{}.{}' is {} there and {} here; restart the service "
                     "with this bench file, or correct the file",
                     source, bench, host.empty() ? "" : " on " + host, source, difference.key,
                     value_phrase(difference.service_value), value_phrase(difference.run_value));
}

} // namespace dyncal::inline contract
