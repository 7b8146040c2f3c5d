#include "services/views/report/result_file.hpp"

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/counted_file.hpp"

namespace dyncal::services {
namespace {

// So that a factor of 2 gives U. Files of versions before the schema have u alone, which was that.
double half_of_expanded(const nlohmann::json& point, const char* expanded, const char* standard) {
  const auto found = point.find(expanded);
  return found != point.end() && found->is_number() ? 0.5 * found->get<double>()
                                                    : point.at(standard).get<double>();
}

} // namespace

Expected<ResultPoints> read_result_file(const std::filesystem::path& path) {
  ByteCount no_progress;
  return read_result_file(path, no_progress);
}

Expected<ResultPoints> read_result_file(const std::filesystem::path& path, ByteCount& bytes) {
  CountedFile file(path, bytes);
  if (!file.stream()) {
    return fail(ErrorCode::bad_file, fmt::format("{} cannot be read", path.string()));
  }
  const auto json = nlohmann::json::parse(file.stream(), nullptr, false);
  ResultPoints points;
  try {
    for (const auto& point : json.at("transfer_function")) {
      if (point.at("magnitude").is_null() || point.at("phase_rad").is_null()) {
        continue;
      }
      points[{point.at("channel"), point.at("frequency_hz")}] = {
          point.value("unit", ""),
          {point.at("magnitude"), half_of_expanded(point, "U_magnitude", "u_magnitude"),
           point.at("phase_rad"), half_of_expanded(point, "U_phase_rad", "u_phase_rad")}};
    }
  } catch (const nlohmann::json::exception&) {
    return fail(ErrorCode::bad_file,
                fmt::format("{} is not a result of dyncal: it has no "
                            "'transfer_function' with magnitude and phase, each "
                            "with its uncertainty",
                            path.string()));
  }
  return points;
}

} // namespace dyncal::services
