// What is wrong with the folder that a secured program is given (identity_folder.hpp): all that
// would keep others from talking to it, most of which neither DDS vendor says, and none of them to
// people. `dyncal security check` prints it, and no program joins the network with an error in it.
//
// Checked are modes of files, kind of key, subject, chain, revocation, validity, signatures,
// governance, permissions and their partitions, and plug-ins of the vendor. Any thread.
#pragma once

#include <chrono>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/base/finding.hpp"
#include "services/bus/bus.hpp"

namespace dyncal::inline security {

struct IdentityCheck {
  Findings findings;   // each sentence begins with its file
  std::string name;    // of the certificate, "source-acc-1"; empty: there is none
  std::time_t end = 0; // of certificate or permissions, whichever ends first
};

[[nodiscard]] IdentityCheck check_identity(const std::filesystem::path& folder, bus::Vendor vendor,
                                           std::time_t now);

// Vendors that the folder has a certificate for.
[[nodiscard]] std::vector<bus::Vendor> vendors_of(const std::filesystem::path& folder);

// Fails (bad_file) with the first error that a program finds in its own folder, or where the role
// of the certificate is none of `program` ("dyncal-dau").
[[nodiscard]] Expected<void> require_identity(const std::filesystem::path& folder,
                                              bus::Vendor vendor, const std::string& program,
                                              std::time_t now);

// Fails (bad_file) where the folder has a certificate for another DDS vendor too: of a vendor that
// talks to no other once it is secured, since such a laboratory may be mixed.
[[nodiscard]] Expected<void> require_no_other_vendor(const std::filesystem::path& folder,
                                                     bus::Vendor vendor);

// Fails (bad_file) where certificate or permissions end within this time.
[[nodiscard]] Expected<void> require_validity(const std::filesystem::path& folder,
                                              bus::Vendor vendor, std::chrono::seconds needed,
                                              std::time_t now);

} // namespace dyncal::inline security
