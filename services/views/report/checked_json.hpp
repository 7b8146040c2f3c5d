// One object of a JSON file that others may have written or changed: every key is checked when it
// is read, and what is wrong is named by its place ("transfer_function[3].U_magnitude").
//
// Throws BadKey, whose sentence the reader of the file turns into its own error; nothing else
// leaves these functions. The JSON must outlive the object. Any thread.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace dyncal::services {

struct BadKey {
  std::string sentence;
};

class CheckedJson {
public:
  // `place` is empty for the file itself.
  CheckedJson(const nlohmann::json& json, std::string place);

  [[nodiscard]] double number(const char* key) const; // NaN: null
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] bool boolean(const char* key) const;
  [[nodiscard]] std::vector<std::string> texts(const char* key) const;
  [[nodiscard]] std::vector<CheckedJson> nodes(const char* key) const;
  [[nodiscard]] CheckedJson node(const char* key) const { return {at(key), key}; }
  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }
  // What older files have not: otherwise if the key is absent or null.
  [[nodiscard]] std::string text_or(const char* key, const std::string& otherwise) const;
  [[nodiscard]] double number_or(const char* key, double otherwise) const;

private:
  [[nodiscard]] const nlohmann::json& at(const char* key) const;
  [[nodiscard]] const nlohmann::json& array(const char* key) const;
  [[nodiscard]] bool is_known(const char* key) const;
  [[nodiscard]] std::string name_of(const char* key) const;

  const nlohmann::json& json_;
  std::string place_;
};

} // namespace dyncal::services
