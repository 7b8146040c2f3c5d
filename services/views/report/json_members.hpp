// Writes and reads the members of a result (evaluation/result/members.hpp) as JSON. Numbers that
// are not finite, and what is not known, are null.
//
// Reading needs JSON that its schema has passed (json_schema.hpp): members of another type are left
// as they are, like members that are not there. A whole number beyond its type is the nearest one.
// Templates, any thread.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "services/evaluation/result/members.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::inline views {

class JsonWriter {
public:
  using Json = nlohmann::ordered_json;
  explicit JsonWriter(Json& json) : json_(json) {}

  template <class T>
  void operator()(const char* name, const T& value) {
    json_[name] = of(value);
  }
  // Absent where there is none.
  template <class T>
  void operator()(const char* name, const std::optional<T>& value) {
    if (value) {
      json_[name] = of(*value);
    }
  }
  template <class T>
  void derived(const char* name, const T& value) {
    json_[name] = of(value);
  }
  template <class T>
  void derived(const char* name, const std::optional<T>& value) {
    json_[name] = value ? of(*value) : Json(nullptr);
  }
  template <class T>
  void derived_if(const char* name, const std::optional<T>& value) {
    (*this)(name, value);
  }
  template <class T>
  void unless_empty(const char* name, const T& value) {
    if (!value.empty()) {
      json_[name] = of(value);
    }
  }
  template <class T>
  void unless(const char* name, const T& value, const T& usual) {
    if (value != usual) {
      json_[name] = of(value);
    }
  }
  template <class Enum>
  void named(const char* name, Enum value, Enum last) {
    named(name, value, last, [](Enum one) { return to_string(one); });
  }
  template <class Enum, class TextOf>
  void named(const char* name, Enum value, Enum /*last*/, TextOf text_of) {
    json_[name] = text_of(value);
  }
  void known(const char* name, double value) {
    json_[name] = value == 0.0 ? Json(nullptr) : json_number(value);
  }
  void known(const char* name, const std::string& text) {
    json_[name] = text.empty() ? Json(nullptr) : Json(text);
  }
  void if_known(const char* name, double value) {
    if (!std::isnan(value)) {
      json_[name] = json_number(value);
    }
  }
  void range(const char* low_name, double low, const char* high_name, double high) {
    json_[low_name] = low == high ? Json(nullptr) : json_number(low);
    json_[high_name] = low == high ? Json(nullptr) : json_number(high);
  }
  void infinite(const char* name, double value) { json_[name] = json_number(value); }
  void utc(const char* name, std::int64_t utc_ns) { known(name, utc_text(utc_ns)); }
  void flags(const std::vector<Flag>& flags) {
    json_["flags"] = sentences_of(flags);
    json_["flag_names"] = names_of(flags);
  }
  template <class List>
  void object(const char* name, const List& list) {
    Json json = Json::object();
    JsonWriter inner(json);
    list(inner);
    json_[name] = std::move(json);
  }

  template <class T>
  [[nodiscard]] static Json of(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      return json_number(value);
    } else if constexpr (std::is_constructible_v<Json, const T&>) {
      return value;
    } else {
      Json json = Json::object();
      JsonWriter writer(json);
      members(writer, value);
      return json;
    }
  }
  template <class T>
  [[nodiscard]] static Json of(const std::vector<T>& values) {
    Json json = Json::array();
    for (const T& value : values) {
      json.push_back(of(value));
    }
    return json;
  }

private:
  Json& json_;
};

class JsonReader {
public:
  using Json = nlohmann::json;
  explicit JsonReader(const Json& json) : json_(json) {}

  template <class T>
  void operator()(const char* name, T& value) {
    if (const auto found = json_.find(name); found != json_.end()) {
      read(*found, value);
    }
  }
  template <class T>
  void derived(const char* /*name*/, const T& /*value*/) {}
  template <class T>
  void derived_if(const char* /*name*/, const T& /*value*/) {}
  template <class T>
  void unless_empty(const char* name, T& value) {
    (*this)(name, value);
  }
  template <class T>
  void unless(const char* name, T& value, const T& /*usual*/) {
    (*this)(name, value);
  }
  template <class Enum>
  void named(const char* name, Enum& value, Enum last) {
    named(name, value, last, [](Enum one) { return to_string(one); });
  }
  template <class Enum, class TextOf>
  void named(const char* name, Enum& value, Enum last, TextOf text_of) {
    std::string text;
    (*this)(name, text);
    for (int i = 0; i <= static_cast<int>(last); ++i) {
      if (text_of(static_cast<Enum>(i)) == text) {
        value = static_cast<Enum>(i);
      }
    }
  }
  void known(const char* name, double& value) { number(name, 0.0, value); }
  void known(const char* name, std::string& text) { (*this)(name, text); }
  void if_known(const char* name, double& value) { (*this)(name, value); }
  void range(const char* low_name, double& low, const char* high_name, double& high) {
    known(low_name, low);
    known(high_name, high);
  }
  void infinite(const char* name, double& value) {
    number(name, std::numeric_limits<double>::infinity(), value);
  }
  void utc(const char* name, std::int64_t& utc_ns) {
    std::string text;
    (*this)(name, text);
    utc_ns = parse_utc_text(text);
  }
  void flags(std::vector<Flag>& flags) {
    std::vector<std::string> sentences;
    std::vector<std::string> names;
    (*this)("flags", sentences);
    (*this)("flag_names", names);
    flags = flags_from_message(sentences, names);
  }
  template <class List>
  void object(const char* name, const List& list) {
    if (const auto found = json_.find(name); found != json_.end()) {
      JsonReader inner(*found);
      list(inner);
    }
  }

private:
  void number(const char* name, double of_null, double& value) {
    if (const auto found = json_.find(name); found != json_.end()) {
      read(*found, value);
      value = found->is_null() ? of_null : value;
    }
  }

  template <class T>
  static void read(const Json& json, T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = json.is_boolean() ? json.get<bool>() : value;
    } else if constexpr (std::is_floating_point_v<T>) {
      value = json.is_number() ? json.get<T>() : std::numeric_limits<T>::quiet_NaN();
    } else if constexpr (std::is_integral_v<T>) {
      value = whole<T>(json, value);
    } else {
      JsonReader reader(json);
      members(reader, value);
    }
  }
  static void read(const Json& json, std::string& text) {
    text = json.is_string() ? json.get<std::string>() : std::string();
  }
  template <class T>
  static void read(const Json& json, std::optional<T>& value) {
    if (!json.is_null()) {
      read(json, value.emplace());
    }
  }
  template <class T>
  static void read(const Json& json, std::vector<T>& values) {
    values.clear();
    for (const Json& one : json) {
      read(one, values.emplace_back());
    }
  }

  template <class T>
  static T whole(const Json& json, T otherwise) {
    using Wide = std::int64_t;
    constexpr double max_exact = 9007199254740992.0; // 2^53
    constexpr Wide max_wide = std::numeric_limits<Wide>::max();
    constexpr Wide low = std::is_signed_v<T> ? Wide{std::numeric_limits<T>::min()} : 0;
    constexpr Wide high =
        sizeof(T) < sizeof(Wide) ? static_cast<Wide>(std::numeric_limits<T>::max()) : max_wide;
    if (!json.is_number()) {
      return otherwise;
    }
    Wide number = 0;
    if (json.is_number_float()) {
      number = static_cast<Wide>(std::clamp(json.get<double>(), -max_exact, max_exact));
    } else if (json.is_number_unsigned()) {
      number = static_cast<Wide>(std::min<std::uint64_t>(json.get<std::uint64_t>(), max_wide));
    } else {
      number = json.get<Wide>();
    }
    return static_cast<T>(std::clamp(number, low, high));
  }

  const Json& json_;
};

} // namespace dyncal::inline views
