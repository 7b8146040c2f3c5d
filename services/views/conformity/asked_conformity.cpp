#include "services/views/conformity/asked_conformity.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::inline views {

Expected<std::optional<ConformityReport>>
asked_conformity(const StoredResult& result, const std::vector<std::string>& channels,
                 const std::filesystem::path& tolerance_file,
                 const std::optional<Tolerances>& of_sensor) {
  std::optional<Tolerances> tolerances = of_sensor;
  if (!tolerance_file.empty()) {
    DYNCAL_TRY(tolerances, read_tolerance_file(tolerance_file));
  }
  if (!tolerances) {
    return std::nullopt;
  }
  for (const std::string& channel : channels) {
    if (std::ranges::find(result.channels, channel, &StoredChannel::channel) ==
        result.channels.end()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("{}: there is no channel '{}'", result.file.string(), channel));
    }
  }
  return judge_conformity(result, channels, std::move(*tolerances));
}

} // namespace dyncal::inline views
