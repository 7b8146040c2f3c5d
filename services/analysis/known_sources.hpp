// What the analysis service knows of the sources of a bench, whether a run uses them or not: the
// newest description and status of each, by name. Plain data.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "idl/dyncal.h"

namespace dyncal::services {

struct KnownSource {
  std::optional<wire::SourceDescription> description;
  std::optional<wire::SourceStatus> status;
};
using KnownSources = std::map<std::string, KnownSource>;

} // namespace dyncal::services
