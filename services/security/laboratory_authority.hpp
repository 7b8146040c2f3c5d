// The authority of a laboratory, a folder on a computer of its own: it issues the folders that
// secured programs are given (identity_folder.hpp), and revokes certificates.
//
//   ca.pem, ca_key.pem   its certificate, and its private key: who has it can be anybody
//   governance.p7s       signed once
//   revoked.pem          the list of revoked certificates; copied to where programs run
//   issued/              a copy of each certificate, NAME.VENDOR.pem
//
// Private keys are files that their owner alone can read, and are never shown. Not for two threads
// or programs at once.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/participant_security.hpp"
#include "services/contract/topic_access.hpp"
#include "services/security/pem_file.hpp"

namespace dyncal::inline security {

// An authority that a laboratory has already.
struct OwnAuthority {
  std::filesystem::path certificate;
  std::filesystem::path private_key;
};

struct IdentityRequest {
  SecurityRole role = SecurityRole::watcher;
  std::vector<std::string> benches; // of a role that belongs to some
  std::string name;                 // what tells it from others; empty: the benches
  double days = 365.0;
  std::vector<bus::Vendor> vendors;
};

struct IssuedCertificate {
  std::string name; // "source-acc-1"
  std::string vendor;
  std::time_t end = 0;
  bool revoked = false;
};

class LaboratoryAuthority {
public:
  // Makes the folder. `laboratory`: letters, digits, blanks, "-._". Fails (bad_argument) on another
  // name, or where the folder has an authority already.
  [[nodiscard]] static Expected<LaboratoryAuthority> create(const std::filesystem::path& folder,
                                                            const std::string& laboratory);
  // With one that is there. Fails (bad_file) where it cannot sign, or DDS vendors do not take it.
  [[nodiscard]] static Expected<LaboratoryAuthority> create(const std::filesystem::path& folder,
                                                            const OwnAuthority& own);
  [[nodiscard]] static Expected<LaboratoryAuthority> open(const std::filesystem::path& folder);

  // Writes a folder for a program, which must be new or empty. Returns the name of its
  // certificates. Fails (bad_argument) where the role and the benches do not go together.
  [[nodiscard]] Expected<std::string> issue(const IdentityRequest& request,
                                            const std::filesystem::path& output) const;
  // All certificates of this name. Fails (bad_argument) when there is none.
  [[nodiscard]] Expected<void> revoke(const std::string& name) const;
  // By name.
  [[nodiscard]] Expected<std::vector<IssuedCertificate>> issued() const;
  [[nodiscard]] const X509& certificate() const { return *certificate_; }

private:
  LaboratoryAuthority(std::filesystem::path folder, OpenSslPointer<X509> certificate,
                      OpenSslPointer<EVP_PKEY> key)
      : folder_(std::move(folder)), certificate_(std::move(certificate)), key_(std::move(key)) {}
  [[nodiscard]] Expected<void> begin() const;
  [[nodiscard]] std::string free_name(const IdentityRequest& request) const;
  [[nodiscard]] Expected<void> issue_for(bus::Vendor vendor, const std::string& name,
                                         const IdentityRequest& request,
                                         const std::filesystem::path& output) const;

  std::filesystem::path folder_;
  OpenSslPointer<X509> certificate_;
  OpenSslPointer<EVP_PKEY> key_;
};

} // namespace dyncal::inline security
