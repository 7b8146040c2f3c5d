// What the analysis service knows of the sources of a bench, whether a run uses them or not: the
// newest description and status of each, by name, and whether two services take turns as one. Plain
// data.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "idl/dyncal.h"
#include "services/analysis/twin_watch.hpp"

namespace dyncal::services {

struct KnownSource {
  std::optional<wire::SourceDescription> description;
  std::optional<wire::SourceDescription> before{}; // of the session before: a restart, or a twin
  std::optional<wire::SourceStatus> status;
  TwinWatch twins{5}; // by statuses, one a second: a twin that has ended is soon forgotten
};
using KnownSources = std::map<std::string, KnownSource>;

// Host and process of the service that described a source; empty where it does not say.
[[nodiscard]] std::string service_of(const std::optional<wire::SourceDescription>& description);

// The sentence about twins; the services may be empty.
[[nodiscard]] std::string two_send_as(const std::string& bench, const std::string& source,
                                      const std::string& one_service,
                                      const std::string& other_service);

} // namespace dyncal::services
