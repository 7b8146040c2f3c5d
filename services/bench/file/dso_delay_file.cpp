#include "services/bench/file/dso_delay_file.hpp"

#include <cmath>
#include <fstream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace dyncal::inline bench {

Expected<DsoDelay> read_dso_delay_file(const std::filesystem::path& path) {
  const auto refused = [&](const std::string& why) {
    return fail(ErrorCode::bad_file, fmt::format("{}: {}", path.string(), why));
  };
  std::ifstream stream(path);
  if (!stream || std::filesystem::is_directory(path)) {
    return refused("cannot be read; \"dyncal calibrate dso-delay\" writes such a file");
  }
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  if (!json.is_object() || !json.contains("value_s") || !json.contains("u_s") ||
      !json["value_s"].is_number() || !json["u_s"].is_number()) {
    return refused("is no JSON object with the numbers value_s and u_s");
  }
  const DsoDelay delay{json["value_s"].get<double>(), json["u_s"].get<double>()};
  if (!std::isfinite(delay.value_s) || !std::isfinite(delay.u_s) || delay.u_s < 0.0) {
    return refused("value_s and u_s must be finite, and u_s not negative");
  }
  return delay;
}

} // namespace dyncal::inline bench
