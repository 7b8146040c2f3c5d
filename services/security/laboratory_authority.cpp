#include "services/security/laboratory_authority.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include <fmt/format.h>
#include <openssl/x509v3.h>

#include "drivers/link/file_descriptor.hpp"
#include "services/base/output_file.hpp"
#include "services/base/output_stream.hpp"
#include "services/base/whole_file.hpp"
#include "services/security/access_documents.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/signed_document.hpp"
#include "services/security/x509_making.hpp"

namespace dyncal::inline security {
namespace {

namespace fs = std::filesystem;

constexpr const char* key_file = "ca_key.pem";
constexpr const char* issued_folder = "issued";
constexpr double seconds_per_day = 86400.0;
constexpr double authority_days = 3653.0;
// Clocks of hosts that are behind by less take a certificate that has just been issued.
constexpr std::time_t clock_allowance_s = 3600;
constexpr std::size_t longest_name = 64; // of a common name (X.520)
constexpr std::size_t max_file_bytes = 1U << 20U;

Validity validity_of_days(double days) {
  const std::time_t now = std::time(nullptr);
  return {now - clock_allowance_s, now + std::lround(days * seconds_per_day)};
}

bool is_safe(char c, bool with_blanks) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' || c == '_' ||
         (with_blanks && c == ' ');
}

bool is_safe_name(const std::string& name, bool with_blanks) {
  return !name.empty() && name.size() <= longest_name && name.front() != ' ' &&
         name.back() != ' ' &&
         std::ranges::all_of(name, [&](char c) { return is_safe(c, with_blanks); });
}

// For its owner alone.
Expected<void> write_private_file(const fs::path& path, const std::string& text) {
  const drivers::FileDescriptor file(
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open() ||
      ::write(file.number(), text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
      ::fsync(file.number()) != 0) {
    return cannot_be_written(path, errno);
  }
  return {};
}

// A new or empty folder that others cannot look into.
Expected<void> make_private_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) {
    return cannot_be_written(folder, problem.value());
  }
  if (!fs::is_empty(folder, problem)) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: holds something already; name a new folder", folder.string()));
  }
  fs::permissions(folder, fs::perms::owner_all, problem);
  return problem ? cannot_be_written(folder, problem.value()) : Expected<void>{};
}

Error cannot_sign(const fs::path& folder) {
  return {
      ErrorCode::bad_file,
      fmt::format("{}: the private key is not that of the certificate beside it", folder.string())};
}

Expected<void> check_request(const IdentityRequest& request) {
  if (is_of_a_bench(request.role) && request.benches.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("role '{}' belongs to a bench: name it by --bench (repeatable)",
                            to_string(request.role)));
  }
  if (!is_of_a_bench(request.role) && !request.benches.empty()) {
    return fail(
        ErrorCode::bad_argument,
        fmt::format("role '{}' is for all benches: without --bench", to_string(request.role)));
  }
  for (const std::string& bench : request.benches) {
    DYNCAL_TRY(bus::check_bench_name(bench));
  }
  if (!request.name.empty() && !is_safe_name(request.name, false)) {
    return fail(ErrorCode::bad_argument,
                "--name " + request.name + ": up to 64 letters, digits and -._ are allowed");
  }
  if (!(request.days > 0.0)) {
    return fail(ErrorCode::bad_argument, "--days must be above 0");
  }
  return {};
}

bool is_self_signed(X509& certificate) {
  return X509_check_ca(&certificate) == 1 && X509_check_issued(&certificate, &certificate) == 0;
}

} // namespace

Expected<LaboratoryAuthority> LaboratoryAuthority::create(const fs::path& folder,
                                                          const std::string& laboratory) {
  if (!is_safe_name(laboratory, true)) {
    return fail(ErrorCode::bad_argument, "the name of the laboratory '" + laboratory +
                                             "' must have 1 to 64 letters, digits, blanks and -._");
  }
  DYNCAL_TRY(make_private_folder(folder));
  auto key = make_private_key();
  auto certificate = make_authority(laboratory, *key, validity_of_days(authority_days));
  DYNCAL_TRY(write_private_file(folder / key_file, pem_text(*key)));
  LaboratoryAuthority authority(folder, std::move(certificate), std::move(key));
  DYNCAL_TRY(authority.begin());
  return authority;
}

Expected<LaboratoryAuthority> LaboratoryAuthority::create(const fs::path& folder,
                                                          const OwnAuthority& own) {
  DYNCAL_TRY(auto certificates, read_certificates(own.certificate));
  DYNCAL_TRY(auto key, read_private_key(own.private_key));
  X509& certificate = *certificates.front();
  if (X509_check_private_key(&certificate, key.get()) != 1) {
    return fail(cannot_sign(own.private_key));
  }
  if (!is_self_signed(certificate) || !is_usable(key.get())) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: must be the certificate of an authority (CA:TRUE) that it has "
                            "signed itself, with a key of P-256 or RSA: DDS takes no other",
                            own.certificate.string()));
  }
  DYNCAL_TRY(const auto key_text, read_whole_file(own.private_key, max_file_bytes));
  DYNCAL_TRY(make_private_folder(folder));
  DYNCAL_TRY(write_private_file(folder / key_file, key_text)); // with its password, if it has one
  LaboratoryAuthority authority(folder, std::move(certificates.front()), std::move(key));
  DYNCAL_TRY(authority.begin());
  return authority;
}

Expected<void> LaboratoryAuthority::begin() const {
  DYNCAL_TRY(write_new_file(folder_ / authority_file, pem_text(*certificate_)));
  DYNCAL_TRY(const auto governance, sign_document(governance_text(), *certificate_, *key_));
  DYNCAL_TRY(write_new_file(folder_ / governance_file, governance));
  const auto revoked = make_revoked(nullptr, {}, *certificate_, *key_);
  if (!revoked) {
    return fail(cannot_sign(folder_));
  }
  DYNCAL_TRY(write_new_file(folder_ / revoked_file, pem_text(*revoked)));
  return make_private_folder(folder_ / issued_folder);
}

Expected<LaboratoryAuthority> LaboratoryAuthority::open(const fs::path& folder) {
  DYNCAL_TRY(auto certificates, read_certificates(folder / authority_file));
  DYNCAL_TRY(auto key, read_private_key(folder / key_file));
  if (X509_check_private_key(certificates.front().get(), key.get()) != 1) {
    return fail(cannot_sign(folder));
  }
  return LaboratoryAuthority(folder, std::move(certificates.front()), std::move(key));
}

std::string LaboratoryAuthority::free_name(const IdentityRequest& request) const {
  constexpr std::size_t longest_number = 4; // "-999"
  std::string name = to_string(request.role);
  if (!request.name.empty()) {
    name += "-" + request.name;
  }
  for (const std::string& bench :
       request.name.empty() ? request.benches : std::vector<std::string>()) {
    name += "-" + bench;
  }
  name.resize(std::min(name.size(), longest_name - longest_number));
  std::ranges::replace_if(
      name, [](char c) { return !is_safe(c, false); }, '_');
  std::string free = name;
  const auto is_taken = [&](bus::Vendor vendor) {
    return fs::exists(folder_ / issued_folder / (free + "." + bus::to_string(vendor) + ".pem"));
  };
  for (int number = 2; std::ranges::any_of(bus::vendors_in_this_build(), is_taken); ++number) {
    free = fmt::format("{}-{}", name, number);
  }
  return free;
}

Expected<void> LaboratoryAuthority::issue_for(bus::Vendor vendor, const std::string& name,
                                              const IdentityRequest& request,
                                              const fs::path& output) const {
  Applicant applicant{subject_part(*certificate_, NID_organizationName), name,
                      bus::needs_high_subject(vendor), validity_of_days(request.days)};
  applicant.validity.end = std::min(applicant.validity.end, validity_of(*certificate_).end);
  const auto key = make_private_key();
  const auto certificate = make_certificate(applicant, *key, *certificate_, *key_);
  if (!certificate) {
    return fail(cannot_sign(folder_));
  }
  const auto files = security_files(output, vendor);
  DYNCAL_TRY(const auto permissions,
             sign_document(permissions_text(subject_text(*certificate), applicant.validity,
                                            request.role, request.benches),
                           *certificate_, *key_));
  const std::string text = pem_text(*certificate);
  DYNCAL_TRY(write_new_file(
      folder_ / issued_folder / (name + "." + bus::to_string(vendor) + ".pem"), text));
  DYNCAL_TRY(write_new_file(files.certificate, text));
  DYNCAL_TRY(write_new_file(files.permissions, permissions));
  return write_private_file(files.private_key, pem_text(*key));
}

Expected<std::string> LaboratoryAuthority::issue(const IdentityRequest& request,
                                                 const fs::path& output) const {
  DYNCAL_TRY(check_request(request));
  DYNCAL_TRY(make_private_folder(output));
  for (const char* file : {authority_file, governance_file, revoked_file}) {
    DYNCAL_TRY(const auto text, read_whole_file(folder_ / file, max_file_bytes));
    DYNCAL_TRY(write_new_file(output / file, text));
  }
  const std::string name = free_name(request);
  for (const bus::Vendor vendor : request.vendors) {
    DYNCAL_TRY(issue_for(vendor, name, request, output));
  }
  return name;
}

Expected<void> LaboratoryAuthority::revoke(const std::string& name) const {
  Certificates certificates;
  for (const bus::Vendor vendor : bus::vendors_in_this_build()) {
    const auto path = folder_ / issued_folder / (name + "." + bus::to_string(vendor) + ".pem");
    if (is_safe_name(name, false) && fs::exists(path)) {
      DYNCAL_TRY(auto one, read_certificates(path));
      certificates.push_back(std::move(one.front()));
    }
  }
  if (certificates.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: no certificate '{}' has been issued; 'dyncal security show {}' "
                            "lists them",
                            folder_.string(), name, folder_.string()));
  }
  DYNCAL_TRY(const auto before, read_revoked(folder_ / revoked_file));
  std::erase_if(certificates, [&](const auto& one) {
    X509_REVOKED* found = nullptr;
    return X509_CRL_get0_by_cert(before.get(), &found, one.get()) == 1;
  });
  const auto revoked = make_revoked(before.get(), certificates, *certificate_, *key_);
  return revoked ? write_output_file(folder_ / revoked_file, pem_text(*revoked))
                 : fail(cannot_sign(folder_));
}

Expected<std::vector<IssuedCertificate>> LaboratoryAuthority::issued() const {
  DYNCAL_TRY(const auto revoked, read_revoked(folder_ / revoked_file));
  std::vector<IssuedCertificate> all;
  std::error_code unreadable;
  for (const auto& file : fs::directory_iterator(folder_ / issued_folder, unreadable)) {
    DYNCAL_TRY(const auto certificates, read_certificates(file.path()));
    X509* certificate = certificates.front().get();
    X509_REVOKED* found = nullptr;
    all.push_back({.name = subject_part(*certificate, NID_commonName),
                   .vendor = file.path().stem().extension().string().substr(1),
                   .end = validity_of(*certificate).end,
                   .revoked = X509_CRL_get0_by_cert(revoked.get(), &found, certificate) == 1});
  }
  std::ranges::sort(all, {}, [](const auto& one) { return std::tie(one.name, one.vendor); });
  return all;
}

} // namespace dyncal::inline security
