#include "services/views/report/daily_check.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

std::string sentence_of(const DailyCheck& check) {
  if (!check.left_out.empty()) {
    return fmt::format("The daily check of the bench with sensor {} was left out: {}", check.sensor,
                       check.left_out);
  }
  if (check.run.empty()) {
    return fmt::format("This run is of the check sensor of the bench, {}", check.sensor);
  }
  return fmt::format("Daily check of the bench with sensor {}, run {} of {}: {}", check.sensor,
                     check.run, check.began_utc, check.state);
}

void add_check(const std::optional<DailyCheck>& check, nlohmann::ordered_json& result) {
  if (check) {
    result["check"] = {{"sensor", check->sensor},
                       {"run", check->run},
                       {"began_utc", check->began_utc},
                       {"state", check->state},
                       {"left_out", check->left_out}};
  }
}

std::optional<DailyCheck> daily_check_of(const std::filesystem::path& result_file) {
  const auto text = read_result_text(result_file);
  const auto json = nlohmann::json::parse(text ? *text : "", nullptr, false);
  if (!json.is_object() || !json.contains("check") || !json["check"].is_object()) {
    return std::nullopt;
  }
  const auto member = [&](const char* name) {
    const nlohmann::json found = json["check"].value(name, nlohmann::json());
    return found.is_string() ? found.get<std::string>() : std::string();
  };
  return DailyCheck{.sensor = member("sensor"),
                    .run = member("run"),
                    .began_utc = member("began_utc"),
                    .state = member("state"),
                    .left_out = member("left_out")};
}

} // namespace dyncal::inline views
