#include "services/analysis/known_sources.hpp"

#include <fmt/core.h>

namespace dyncal::services {

std::string service_of(const std::optional<wire::SourceDescription>& description) {
  return !description || description->host().empty()
             ? ""
             : fmt::format("{}:{}", description->host(), description->process_id());
}

std::string two_send_as(const std::string& bench, const std::string& source,
                        const std::string& one_service, const std::string& other_service) {
  const bool are_known = !one_service.empty() && !other_service.empty();
  return fmt::format(
      "two services{} send as source '{}' of bench '{}'; end one of them, or give it another name",
      are_known ? fmt::format(" ({} and {})", one_service, other_service) : "", source, bench);
}

} // namespace dyncal::services
