#include "services/security/identity_check.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/x509_vfy.h>

#include "services/security/access_documents.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/pem_file.hpp"
#include "services/security/signed_document.hpp"
#include "services/security/x509_making.hpp"

namespace dyncal::inline security {
namespace {

namespace fs = std::filesystem;

constexpr std::time_t warning_s = 30 * std::time_t{86400};
constexpr const char* issue_again = "issue it again by 'dyncal security issue'";

// What is read of a folder, one thing after the other.
class FolderCheck {
public:
  FolderCheck(const fs::path& folder, bus::Vendor vendor, std::time_t now)
      : files_(security_files(folder, vendor)), vendor_(vendor), now_(now) {}

  IdentityCheck run() {
    if (const auto lacks = bus::what_security_lacks(vendor_)) {
      error(files_.certificate, *lacks);
    }
    const auto authorities = read(read_certificates(files_.authority));
    const auto certificates = read(read_certificates(files_.certificate));
    check_private_key(certificates ? certificates->front().get() : nullptr);
    if (certificates && authorities) {
      check_certificate(*certificates->front(), *authorities->front());
      check_governance(*authorities->front());
      check_permissions(*certificates->front(), *authorities->front());
    }
    return std::move(outcome_);
  }

private:
  template <class T>
  std::optional<T> read(Expected<T> outcome) {
    if (!outcome) {
      outcome_.findings.push_back({Severity::error, "", outcome.error().message});
      return std::nullopt;
    }
    return std::move(*outcome);
  }
  void error(const fs::path& file, const std::string& sentence) {
    outcome_.findings.push_back(
        {Severity::error, "", fmt::format("{}: {}", file.string(), sentence)});
  }

  void check_private_key(X509* certificate) {
    struct stat status {};
    const bool handed_on = // by the service manager, which keeps others from it by an access list
        std::getenv("CREDENTIALS_DIRECTORY") != nullptr;
    const mode_t foreign = handed_on ? S_IRWXO : S_IRWXO | S_IRWXG;
    if (stat(files_.private_key.c_str(), &status) == 0 && (status.st_mode & foreign) != 0) {
      error(files_.private_key,
            fmt::format("the private key can be read by others (mode {:04o}): chmod 600 {}",
                        status.st_mode & 07777U, files_.private_key.string()));
    }
    const auto key = read(read_private_key(files_.private_key));
    if (key && certificate != nullptr && X509_check_private_key(certificate, key->get()) != 1) {
      error(files_.private_key, "is not the key of the certificate beside it");
    }
    ERR_clear_error();
  }

  void check_certificate(X509& certificate, X509& authority) {
    outcome_.name = subject_part(certificate, NID_commonName);
    if (!is_usable(X509_get0_pubkey(&certificate))) {
      error(files_.certificate, fmt::format("has a key of another kind than P-256 or RSA of 2048 "
                                            "bits, which Cyclone DDS refuses: {}",
                                            issue_again));
    }
    if (has_high_subject(certificate) != bus::needs_high_subject(vendor_)) {
      error(files_.certificate,
            fmt::format("SHA-256 of its subject begins with {}, so that programs over the other "
                        "DDS vendor would never hear of it: {}",
                        has_high_subject(certificate) ? 1 : 0, issue_again));
    }
    check_chain(certificate, authority);
    note_validity(validity_of(certificate), files_.certificate, "the certificate");
  }

  void check_chain(X509& certificate, X509& authority) {
    const auto revoked = read(read_revoked(files_.revoked));
    const OpenSslPointer<X509_STORE> store(X509_STORE_new());
    X509_STORE_add_cert(store.get(), &authority);
    const OpenSslPointer<X509_STORE_CTX> context(X509_STORE_CTX_new());
    X509_STORE_CTX_init(context.get(), store.get(), &certificate, nullptr);
    X509_STORE_CTX_set_flags(context.get(), X509_V_FLAG_NO_CHECK_TIME);
    if (X509_verify_cert(context.get()) != 1) {
      error(files_.certificate, "was not issued by the authority of ca.pem beside it");
    }
    X509_REVOKED* found = nullptr;
    if (revoked && X509_CRL_verify(revoked->get(), X509_get0_pubkey(&authority)) != 1) {
      error(files_.revoked, "is not signed by the authority of ca.pem; copy that of the authority");
    } else if (revoked && X509_CRL_get0_by_cert(revoked->get(), &found, &certificate) == 1) {
      error(files_.certificate, "has been revoked; issue another one by 'dyncal security issue'");
    }
    ERR_clear_error();
  }

  void note_validity(const Validity& validity, const fs::path& file, const std::string& what) {
    outcome_.end = outcome_.end == 0 ? validity.end : std::min(outcome_.end, validity.end);
    if (now_ >= validity.end) {
      error(file,
            fmt::format("{} expired at {} UTC: {}", what, utc_text(validity.end), issue_again));
    } else if (now_ < validity.begin) {
      error(file, fmt::format("{} begins at {} UTC; does the clock of this host go right?", what,
                              utc_text(validity.begin)));
    } else if (validity.end - now_ < warning_s) {
      outcome_.findings.push_back(
          {Severity::warning, "",
           fmt::format("{}: {} expires at {} UTC", file.string(), what, utc_text(validity.end))});
    }
  }

  void check_governance(X509& authority) {
    const auto text = read(read_signed_document(files_.governance, authority));
    if (!text) {
      return;
    }
    for (const char* rule :
         {"allow_unauthenticated_participants", "enable_join_access_control",
          "discovery_protection_kind", "liveliness_protection_kind", "rtps_protection_kind",
          "enable_discovery_protection", "enable_liveliness_protection",
          "enable_read_access_control", "enable_write_access_control", "metadata_protection_kind",
          "data_protection_kind"}) {
      if (const auto wanted = elements_called(rule, governance_text()),
          found = elements_called(rule, *text);
          found != wanted) {
        error(files_.governance,
              fmt::format("{} is {}, not {}: others, which have the governance of 'dyncal security "
                          "init', would not talk to this program",
                          rule, fmt::join(found, ", "), fmt::join(wanted, ", ")));
      }
    }
  }

  void check_permissions(const X509& certificate, X509& authority) {
    const auto text = read(read_signed_document(files_.permissions, authority));
    if (!text) {
      return;
    }
    if (elements_called("subject_name", *text) != std::vector{subject_text(certificate)}) {
      error(files_.permissions, "are those of another certificate than the one beside them");
    }
    std::vector<std::string> rules = elements_called("publish", *text);
    for (std::string& rule : elements_called("subscribe", *text)) {
      rules.push_back(std::move(rule));
    }
    const auto names_partitions = [](const std::string& rule) {
      return !elements_called("partition", rule).empty();
    };
    if (rules.empty() || !std::ranges::all_of(rules, names_partitions)) {
      error(files_.permissions, fmt::format("a rule names no partition, so that it allows none of "
                                            "a bench: {}",
                                            issue_again));
    }
    const auto begin = elements_called("not_before", *text);
    const auto end = elements_called("not_after", *text);
    if (begin.size() == 1 && end.size() == 1) {
      note_validity({time_of(begin.front()), time_of(end.front())}, files_.permissions,
                    "what is permitted");
    }
  }

  static std::time_t time_of(const std::string& text) {
    std::tm parts{};
    return strptime(text.c_str(), "%Y-%m-%dT%H:%M:%S", &parts) != nullptr ? timegm(&parts) : 0;
  }

  bus::SecurityFiles files_;
  bus::Vendor vendor_;
  std::time_t now_;
  IdentityCheck outcome_;
};

// Programs that are not here take any role.
const std::map<std::string, SecurityRole>& roles_of_programs() {
  static const std::map<std::string, SecurityRole> roles{
      {"dyncal-dau", SecurityRole::source},        {"dyncal-acs", SecurityRole::source},
      {"dyncal-can", SecurityRole::source},        {"dyncal-dso", SecurityRole::source},
      {"dyncal-replay", SecurityRole::source},     {"dyncal-analysis", SecurityRole::analysis},
      {"dyncal-guard", SecurityRole::guard},       {"dyncal-run", SecurityRole::conductor},
      {"dyncal-recorder", SecurityRole::recorder}, {"dyncal-web", SecurityRole::web}};
  return roles;
}

} // namespace

IdentityCheck check_identity(const fs::path& folder, bus::Vendor vendor, std::time_t now) {
  return FolderCheck(folder, vendor, now).run();
}

std::vector<bus::Vendor> vendors_of(const fs::path& folder) {
  std::vector<bus::Vendor> vendors = bus::vendors_in_this_build();
  std::erase_if(vendors, [&](bus::Vendor vendor) {
    std::error_code unreadable;
    return !fs::exists(security_files(folder, vendor).certificate, unreadable);
  });
  return vendors;
}

Expected<void> require_no_other_vendor(const fs::path& folder, bus::Vendor vendor) {
  const std::string own = bus::to_string(vendor);
  for (const std::string other : {"cyclonedds", "fastdds"}) { // of any build
    std::error_code unreadable;
    if (other != own && fs::exists(folder / (other + ".pem"), unreadable)) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: is for {} as well, and Fast DDS 3 talks to no other DDS once it "
                              "is secured, nor to Fast DDS 2: use --dds cyclonedds everywhere; or, "
                              "where all programs are over Fast DDS 3, folders for it alone "
                              "('dyncal security issue --vendor {}')",
                              folder.string(), other, own));
    }
  }
  return {};
}

Expected<void> require_identity(const fs::path& folder, bus::Vendor vendor,
                                const std::string& program, std::time_t now) {
  if (bus::speaks_alone_when_secured(vendor)) {
    DYNCAL_TRY(require_no_other_vendor(folder, vendor));
  }
  const IdentityCheck check = check_identity(folder, vendor, now);
  const auto wrong = std::ranges::find(check.findings, Severity::error, &Finding::severity);
  if (wrong != check.findings.end()) {
    return fail(ErrorCode::bad_file, wrong->sentence);
  }
  const auto wanted = roles_of_programs().find(program);
  if (wanted != roles_of_programs().end() && role_called(check.name) != wanted->second) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the certificate '{}' is not of the role '{}', which {} needs",
                            folder.string(), check.name, to_string(wanted->second), program));
  }
  return {};
}

Expected<void> require_validity(const fs::path& folder, bus::Vendor vendor,
                                std::chrono::seconds needed, std::time_t now) {
  const IdentityCheck check = check_identity(folder, vendor, now);
  if (check.end - now < needed.count()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: '{}' expires at {} UTC, before the end of the run, which takes {} "
                            "min: {}",
                            folder.string(), check.name, utc_text(check.end),
                            (needed.count() + 59) / 60, issue_again));
  }
  return {};
}

} // namespace dyncal::inline security
