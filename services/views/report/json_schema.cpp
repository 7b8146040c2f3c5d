#include "services/views/report/json_schema.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::inline views {
namespace {

using Json = nlohmann::json;

// The place grows from the inside out, so that what agrees costs no text.
struct Deviation {
  std::string place;
  std::string what;
};
using Finding = std::optional<Deviation>;

Finding deviates(std::string what) {
  return Deviation{"", std::move(what)};
}

Finding within(const std::string& name, Finding found) {
  const bool joins = found->place.empty() || found->place.front() == '[';
  found->place = name + (joins ? "" : ".") + found->place;
  return found;
}

bool is_whole(const Json& value) {
  constexpr double max_exact = 9007199254740992.0; // 2^53
  if (!value.is_number_float()) {
    return value.is_number_integer();
  }
  const double number = value.get<double>();
  return std::abs(number) <= max_exact && std::trunc(number) == number;
}

bool is_of_type(const Json& value, const std::string& type) {
  return type == "integer"   ? is_whole(value)
         : type == "number"  ? value.is_number()
         : type == "string"  ? value.is_string()
         : type == "boolean" ? value.is_boolean()
         : type == "array"   ? value.is_array()
         : type == "object"  ? value.is_object()
                             : type == "null" && value.is_null();
}

std::string type_text(const std::string& type) {
  static const std::map<std::string, std::string> texts{{"integer", "a whole number"},
                                                        {"number", "a number"},
                                                        {"string", "a text"},
                                                        {"boolean", "true or false"},
                                                        {"array", "a list"},
                                                        {"object", "an object"},
                                                        {"null", "null"}};
  const auto found = texts.find(type);
  return found == texts.end() ? type : found->second;
}

std::string kind_of(const Json& value) {
  return type_text(value.is_number() ? "number" : value.type_name());
}

// As it stands there, if it is short.
std::string shown(const Json& value) {
  constexpr std::size_t max_shown = 60;
  if (value.is_structured()) {
    return kind_of(value);
  }
  const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= max_shown ? text : "too long a text";
}

std::vector<Json> listed(const Json& one_or_more) {
  return one_or_more.is_array() ? one_or_more.get<std::vector<Json>>() : std::vector{one_or_more};
}

std::string joined(const Json& values, const char* between, std::string (*text_of)(const Json&)) {
  std::vector<std::string> texts;
  for (const Json& value : listed(values)) {
    texts.push_back(text_of(value));
  }
  return fmt::format("{}", fmt::join(texts, between));
}

class Check {
public:
  explicit Check(const Json& root) : root_(root) {}

  Finding operator()(const Json& schema, const Json& value) {
    for (const auto& [word, rule] : schema.items()) {
      if (Finding found = value.is_object()  ? of_object(word, rule, schema, value)
                          : value.is_array() ? of_array(word, rule, value)
                                             : of_scalar(word, rule, value)) {
        return found;
      }
      if (Finding found = of_any(word, rule, value)) {
        return found;
      }
    }
    return schema.contains("if") ? condition(schema, value) : std::nullopt; // of what is in order
  }

private:
  Finding of_any(const std::string& word, const Json& rule, const Json& value) {
    if (word == "$ref") {
      const std::string name = rule.get<std::string>();
      return (*this)(root_.at("$defs").at(name.substr(name.rfind('/') + 1)), value);
    }
    if (word == "type") {
      const auto is_that = [&](const Json& type) {
        return is_of_type(value, type.get_ref<const std::string&>());
      };
      const bool is_known =
          rule.is_array() ? std::any_of(rule.begin(), rule.end(), is_that) : is_that(rule);
      return is_known ? std::nullopt
                      : deviates(fmt::format("is {}, not {}",
                                             value.is_number() ? shown(value) : kind_of(value),
                                             joined(rule, " or ", [](const Json& type) {
                                               return type_text(type.get<std::string>());
                                             })));
    }
    if (word == "enum" || word == "const") {
      const std::vector<Json> known = listed(rule);
      return std::find(known.begin(), known.end(), value) != known.end()
                 ? std::nullopt
                 : deviates(fmt::format("is {}, which this version does not know; it knows {}",
                                        shown(value), joined(rule, ", ", shown)));
    }
    return std::nullopt;
  }

  Finding of_scalar(const std::string& word, const Json& rule, const Json& value) {
    if (word == "pattern" && value.is_string()) {
      constexpr std::size_t max_bytes = 4096;
      const auto& text = value.get_ref<const std::string&>();
      const auto& form = rule.get_ref<const std::string&>();
      const auto compiled = forms_.try_emplace(form, form).first;
      return text.size() <= max_bytes && std::regex_search(text, compiled->second)
                 ? std::nullopt
                 : deviates(fmt::format("is {}, which has not the form {}", shown(value), form));
    }
    if (!value.is_number() || !rule.is_number()) {
      return std::nullopt;
    }
    const double number = value.get<double>();
    const double limit = rule.get<double>();
    const char* bound = word == "minimum" && number < limit             ? "at least"
                        : word == "maximum" && number > limit           ? "at most"
                        : word == "exclusiveMinimum" && number <= limit ? "above"
                        : word == "exclusiveMaximum" && number >= limit ? "below"
                                                                        : nullptr;
    return bound == nullptr ? std::nullopt
                            : deviates(fmt::format("is {}, but must be {} {}", shown(value), bound,
                                                   rule.dump()));
  }

  Finding of_array(const std::string& word, const Json& rule, const Json& value) {
    if ((word == "minItems" && value.size() < rule.get<std::size_t>()) ||
        (word == "maxItems" && value.size() > rule.get<std::size_t>())) {
      return deviates(fmt::format("has {} entries, not {}", value.size(), rule.dump()));
    }
    for (std::size_t i = 0; word == "items" && i < value.size(); ++i) {
      if (Finding found = (*this)(rule, value[i])) {
        return within(fmt::format("[{}]", i), std::move(found));
      }
    }
    return std::nullopt;
  }

  Finding of_object(const std::string& word, const Json& rule, const Json& schema,
                    const Json& value) {
    if (word == "required") {
      for (const Json& name : rule) {
        if (const auto& key = name.get_ref<const std::string&>(); !value.contains(key)) {
          return within(key, deviates("is missing"));
        }
      }
    }
    const bool of_described = word == "properties";
    if (!of_described && word != "additionalProperties") {
      return std::nullopt;
    }
    const auto properties = schema.find("properties");
    for (const auto& [key, member] : value.items()) {
      const bool is_described = properties != schema.end() && properties->contains(key);
      if (is_described == of_described) {
        if (Finding found = (*this)(of_described ? rule[key] : rule, member)) {
          return within(key, std::move(found));
        }
      }
    }
    return std::nullopt;
  }

  Finding condition(const Json& schema, const Json& value) {
    const char* branch = (*this)(schema["if"], value) ? "else" : "then";
    return schema.contains(branch) ? (*this)(schema[branch], value) : std::nullopt;
  }

  const Json& root_;
  std::map<std::string, std::regex> forms_;
};

} // namespace

std::optional<std::string> deviation_from(const nlohmann::json& schema,
                                          const nlohmann::json& value) {
  const auto found = Check(schema)(schema, value);
  if (!found) {
    return std::nullopt;
  }
  return (found->place.empty() ? "the whole" : found->place) + " " + found->what;
}

} // namespace dyncal::inline views
