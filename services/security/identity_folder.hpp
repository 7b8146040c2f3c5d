// The folder that a secured program is given (--security): who it is, what it may do, and whom it
// trusts, for either DDS vendor.
//
//   ca.pem                   the authority of the laboratory
//   governance.p7s           how messages are protected
//   revoked.pem              certificates that do not count any more
//   VENDOR.pem, VENDOR_key.pem, VENDOR_permissions.p7s
//                            its certificate, private key and permissions in this DDS vendor
//
// Flat, since service managers hand on files (LoadCredential=). For a second one beside it FOLDER
// may be what the names of its files begin with before a "_", as systemd hands on a whole folder.
// Those are copies of the time when a service begins; DYNCAL_REVOKED names a list of revoked
// certificates that can be renewed. Plain functions; any thread.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "services/bus/participant_security.hpp"
#include "services/contract/topic_access.hpp"

namespace dyncal::inline security {

inline constexpr const char* authority_file = "ca.pem";
inline constexpr const char* governance_file = "governance.p7s";
inline constexpr const char* revoked_file = "revoked.pem";

[[nodiscard]] inline bus::SecurityFiles security_files(const std::filesystem::path& folder,
                                                       bus::Vendor vendor) {
  const std::string name = bus::to_string(vendor);
  const char* revoked = std::getenv("DYNCAL_REVOKED");
  const auto file = [&](const std::string& called) {
    std::filesystem::path handed_on = folder.string() + "_" + called;
    std::error_code unreadable;
    return std::filesystem::exists(handed_on, unreadable) ? handed_on : folder / called;
  };
  return {.authority = file(authority_file),
          .certificate = file(name + ".pem"),
          .private_key = file(name + "_key.pem"),
          .governance = file(governance_file),
          .permissions = file(name + "_permissions.p7s"),
          .revoked = revoked != nullptr ? revoked : file(revoked_file)};
}

// The common name of a certificate is its role, "-", and what tells it from others.
[[nodiscard]] inline std::optional<SecurityRole> role_called(const std::string& common_name) {
  return parse_security_role(common_name.substr(0, common_name.find('-')));
}

} // namespace dyncal::inline security
