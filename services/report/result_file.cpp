#include "services/report/result_file.hpp"

#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dyncal::services {

Expected<ResultPoints> read_result_file(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) {
    return fail(ErrorCode::bad_file, fmt::format("{} cannot be read", path.string()));
  }
  const auto json = nlohmann::json::parse(stream, nullptr, false);
  ResultPoints points;
  try {
    for (const auto& point : json.at("transfer_function")) {
      if (point.at("magnitude").is_null() || point.at("phase_rad").is_null()) {
        continue;
      }
      points[{point.at("channel"), point.at("frequency_hz")}] = {
          point.value("unit", ""),
          {point.at("magnitude"), point.at("u_magnitude"), point.at("phase_rad"),
           point.at("u_phase_rad")}};
    }
  } catch (const nlohmann::json::exception&) {
    return fail(ErrorCode::bad_file,
                fmt::format("{} is no result of dyncal: it has no "
                            "'transfer_function' with magnitude and phase, each "
                            "with its uncertainty",
                            path.string()));
  }
  return points;
}

} // namespace dyncal::services
