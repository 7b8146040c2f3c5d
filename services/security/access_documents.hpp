// What DDS Security is told in a secured laboratory: its governance, the same for everybody, and
// the permissions of one certificate, made from the table of the contract
// (services/contract/topic_access.hpp). As XML texts (OMG DDS Security 1.1, 9.4.1), to be signed.
//
// Everything is encrypted and authenticated, whole messages between two participants excepted
// (rtps_protection_kind NONE), by which DDS implementations of two vendors understand each other.
// Any thread.
#pragma once

#include <ctime>
#include <string>
#include <vector>

#include "services/contract/topic_access.hpp"

namespace dyncal::inline security {

struct Validity {
  std::time_t begin;
  std::time_t end;
};

[[nodiscard]] std::string governance_text();

// `subject` as RFC 2253 writes it.
[[nodiscard]] std::string permissions_text(const std::string& subject, const Validity& validity,
                                           SecurityRole role,
                                           const std::vector<std::string>& benches);

// Of a text as above, whoever has written it: the texts of all elements of this name, in order.
[[nodiscard]] std::vector<std::string> elements_called(const std::string& name,
                                                       const std::string& text);

// "2027-03-01T12:00:00", in UTC
[[nodiscard]] std::string utc_text(std::time_t time);

} // namespace dyncal::inline security
