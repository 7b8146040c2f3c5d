// What the analysis service knows of the sources of a bench, whether a run uses them or not: the
// description of the session that lives, the newest status of each, by name, and whether two
// services take turns as one.
//
// A description belongs to a session: one that came later counts until the statuses show that the
// session before it goes on alone (a twin that came and went, a program of an older contract).
// Bound: descriptions of `max_earlier` sessions besides; the oldest goes. Belongs to one thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "idl/dyncal.h"
#include "services/contract/duplicate_source_detector.hpp"

namespace dyncal::inline contract {

struct KnownSource {
  static constexpr std::size_t max_earlier = 4;
  // One a second; the last of a session that ended may come after the description of the next.
  static constexpr int statuses_of_a_living_session = 3;

  std::optional<wire::SourceDescription> description{};
  std::vector<wire::SourceDescription> earlier{}; // of other sessions, the newest first
  std::optional<wire::SourceStatus> status{};
  DuplicateSourceDetector twins{
      5};                      // by statuses, one a second: a twin that has ended is soon forgotten
  int statuses_of_earlier = 0; // in a row, of one session other than `description`'s

  // Of the session before: a restart, or a twin.
  [[nodiscard]] std::optional<wire::SourceDescription> before() const {
    return earlier.empty() ? std::nullopt : std::optional(earlier.front());
  }
  [[nodiscard]] bool says_that_it_is_silent() const {
    return status &&
           (status->state() == wire::SOURCE_SILENT || status->state() == wire::SOURCE_FAILED);
  }
  // ": " and what its status says; empty where that is nothing.
  [[nodiscard]] std::string reason_given() const {
    return status && !status->message().empty() ? ": " + status->message() : "";
  }
  void take(const wire::SourceDescription& described);
  // Returns the description that is left, when another one is the living session's.
  [[nodiscard]] std::optional<wire::SourceDescription> take(const wire::SourceStatus& reported);
};
using KnownSources = std::map<std::string, KnownSource>;

// Host and process of the service that described a source; empty where it does not say.
[[nodiscard]] std::string service_of(const std::optional<wire::SourceDescription>& description);

// The sentence about twins; the services may be empty.
[[nodiscard]] std::string two_send_as(const std::string& bench, const std::string& source,
                                      const std::string& one_service,
                                      const std::string& other_service);

} // namespace dyncal::inline contract
