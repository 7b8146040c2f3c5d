// Kinds of contributions as files name them, "fit_noise": never changed, and never shown to people,
// who read name() (contribution.hpp). Plain function, any thread.
#pragma once

#include <string_view>

#include "analysis/uncertainty/contribution.hpp"

namespace dyncal::analysis {

[[nodiscard]] std::string_view identifier_of(ContributionKind kind);

} // namespace dyncal::analysis
