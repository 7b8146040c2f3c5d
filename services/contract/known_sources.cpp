#include "services/contract/known_sources.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace dyncal::inline contract {

void KnownSource::take(const wire::SourceDescription& described) {
  if (description && description->session() != described.session()) {
    earlier.insert(earlier.begin(), std::move(*description));
    statuses_of_earlier = 0;
  }
  description = described;
  std::erase_if(earlier, [&](const wire::SourceDescription& one) {
    return one.session() == described.session();
  });
  if (earlier.size() > max_earlier) {
    earlier.pop_back();
  }
}

std::optional<wire::SourceDescription> KnownSource::take(const wire::SourceStatus& reported) {
  const bool is_same = status && status->session() == reported.session();
  status = reported;
  const auto living =
      std::find_if(earlier.begin(), earlier.end(), [&](const wire::SourceDescription& one) {
        return one.session() == reported.session();
      });
  if (!description || living == earlier.end()) {
    statuses_of_earlier = 0;
    return std::nullopt;
  }
  statuses_of_earlier = is_same ? statuses_of_earlier + 1 : 1;
  if (statuses_of_earlier < statuses_of_a_living_session) {
    return std::nullopt;
  }
  statuses_of_earlier = 0;
  std::swap(*description, *living);
  return *living; // which is kept: of two that write at once a late reader sees the second alone
}

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

} // namespace dyncal::inline contract
