#include "services/views/report/checked_json.hpp"

#include <limits>

#include <fmt/core.h>

namespace dyncal::services {

CheckedJson::CheckedJson(const nlohmann::json& json, std::string place)
    : json_(json), place_(std::move(place)) {
  if (!json_.is_object()) {
    throw BadKey{(place_.empty() ? "the whole" : place_) + " is not an object"};
  }
}

std::string CheckedJson::name_of(const char* key) const {
  return place_.empty() ? key : fmt::format("{}.{}", place_, key);
}

const nlohmann::json& CheckedJson::at(const char* key) const {
  const auto found = json_.find(key);
  if (found == json_.end()) {
    throw BadKey{fmt::format("{} is missing", name_of(key))};
  }
  return *found;
}

const nlohmann::json& CheckedJson::array(const char* key) const {
  const nlohmann::json& value = at(key);
  if (!value.is_array()) {
    throw BadKey{fmt::format("{} is not a list", name_of(key))};
  }
  return value;
}

bool CheckedJson::is_known(const char* key) const {
  const auto found = json_.find(key);
  return found != json_.end() && !found->is_null();
}

double CheckedJson::number(const char* key) const {
  const nlohmann::json& value = at(key);
  if (value.is_null()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (!value.is_number()) {
    throw BadKey{fmt::format("{} is not a number", name_of(key))};
  }
  return value.get<double>();
}

std::string CheckedJson::text(const char* key) const {
  const nlohmann::json& value = at(key);
  if (!value.is_string()) {
    throw BadKey{fmt::format("{} is not a text", name_of(key))};
  }
  return value.get<std::string>();
}

bool CheckedJson::boolean(const char* key) const {
  const nlohmann::json& value = at(key);
  if (!value.is_boolean()) {
    throw BadKey{fmt::format("{} is neither true nor false", name_of(key))};
  }
  return value.get<bool>();
}

std::vector<std::string> CheckedJson::texts(const char* key) const {
  std::vector<std::string> result;
  for (const nlohmann::json& value : array(key)) {
    if (!value.is_string()) {
      throw BadKey{fmt::format("{} is not a list of texts", name_of(key))};
    }
    result.push_back(value.get<std::string>());
  }
  return result;
}

std::vector<CheckedJson> CheckedJson::nodes(const char* key) const {
  std::vector<CheckedJson> result;
  for (const nlohmann::json& value : array(key)) {
    result.emplace_back(value, fmt::format("{}[{}]", name_of(key), result.size()));
  }
  return result;
}

std::string CheckedJson::text_or(const char* key, const std::string& otherwise) const {
  return is_known(key) ? text(key) : otherwise;
}

double CheckedJson::number_or(const char* key, double otherwise) const {
  return is_known(key) ? number(key) : otherwise;
}

} // namespace dyncal::services
