// `dyncal security init|issue|revoke|check|show`: the authority of a secured laboratory, and the
// folders that its programs are given (services/security). Belongs to one thread.
#include <ctime>

#include <fmt/format.h>

#include "services/programs/command/command.hpp"
#include "services/security/access_documents.hpp"
#include "services/security/identity_check.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/laboratory_authority.hpp"
#include "services/security/x509_making.hpp"

namespace dyncal::inline programs {
namespace {

constexpr const char* authority_help = "folder of the authority, that 'dyncal security init' made";

struct InitOptions {
  std::string folder;
  std::string laboratory = "Laboratory";
  OwnAuthority own;
};

void add_init(CLI::App& command, InitOptions& init) {
  command.add_option("FOLDER", init.folder, "new folder of the authority; back it up")->required();
  add_default(command, "--laboratory", init.laboratory, "name that certificates carry");
  auto* certificate = command.add_option("--ca", init.own.certificate,
                                         "certificate of an authority that you have (PEM)");
  auto* key = command.add_option("--ca-key", init.own.private_key, "its private key (PEM)");
  certificate->needs(key);
  key->needs(certificate);
}

Expected<void> run_init(const InitOptions& init) {
  DYNCAL_TRY(const auto authority, init.own.certificate.empty()
                                       ? LaboratoryAuthority::create(init.folder, init.laboratory)
                                       : LaboratoryAuthority::create(init.folder, init.own));
  fmt::print("{}: an authority until {} UTC; keep this folder where no bench is, and a copy\n",
             init.folder, utc_text(validity_of(authority.certificate()).end).substr(0, 10));
  return {};
}

struct IssueOptions {
  std::string folder;
  std::string role;
  std::string output;
  IdentityRequest request;
  std::vector<std::string> vendors;
};

void add_issue(CLI::App& command, IssueOptions& issue) {
  std::vector<std::string> roles;
  for (const SecurityRole role : security_roles()) {
    roles.emplace_back(to_string(role));
  }
  std::vector<std::string> vendors;
  for (const bus::Vendor vendor : bus::vendors_in_this_build()) {
    vendors.push_back(bus::to_string(vendor));
  }
  command.add_option("FOLDER", issue.folder, authority_help)->required();
  command.add_option("ROLE", issue.role, "what the program is")
      ->required()
      ->check(CLI::IsMember(roles));
  command.add_option("--output", issue.output, "new folder for the program")->required();
  command.add_option("--bench", issue.request.benches,
                     "bench that it serves (repeatable; of source, guard and operator)");
  command.add_option("--name", issue.request.name,
                     "what tells its certificate from others (default: the benches)");
  add_default(command, "--days", issue.request.days, "how long it is valid", CLI::PositiveNumber);
  command
      .add_option("--vendor", issue.vendors,
                  "DDS implementation that it will use (repeatable; default: any)")
      ->check(CLI::IsMember(vendors));
}

Expected<void> run_issue(IssueOptions& issue) {
  DYNCAL_TRY(const auto authority, LaboratoryAuthority::open(issue.folder));
  issue.request.role = *parse_security_role(issue.role);
  for (const std::string& name : issue.vendors) {
    DYNCAL_TRY(const auto vendor, bus::parse_vendor(name));
    issue.request.vendors.push_back(vendor);
  }
  if (issue.vendors.empty()) {
    issue.request.vendors = bus::vendors_in_this_build();
  }
  DYNCAL_TRY(const auto name, authority.issue(issue.request, issue.output));
  fmt::print("{}: {}\n", issue.output, name);
  return {};
}

struct RevokeOptions {
  std::string folder;
  std::vector<std::string> names;
};

void add_revoke(CLI::App& command, RevokeOptions& revoke) {
  command.add_option("FOLDER", revoke.folder, authority_help)->required();
  command.add_option("NAME", revoke.names, "certificate, as 'dyncal security show' names it")
      ->required();
}

Expected<void> run_revoke(const RevokeOptions& revoke) {
  DYNCAL_TRY(const auto authority, LaboratoryAuthority::open(revoke.folder));
  for (const std::string& name : revoke.names) {
    DYNCAL_TRY(authority.revoke(name));
    fmt::print("{}: revoked\n", name);
  }
  fmt::print("copy {}/{} into the folders of all programs, and restart them when you can\n",
             revoke.folder, revoked_file);
  return {};
}

struct FolderOptions {
  std::string folder;
};

void add_check_security(CLI::App& command, FolderOptions& check) {
  command.add_option("FOLDER", check.folder, "folder of a program, as --security takes it")
      ->required();
  command.footer("Exit status: 0 nothing is wrong (there may be warnings), 3 errors.");
}

Expected<std::vector<bus::Vendor>> vendors_in(const std::string& folder) {
  auto vendors = vendors_of(folder);
  if (vendors.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: holds no certificate of a program; 'dyncal security issue' makes "
                            "such a folder",
                            folder));
  }
  return vendors;
}

Expected<int> run_check_security(const FolderOptions& command) {
  DYNCAL_TRY(const auto vendors, vendors_in(command.folder));
  Findings all;
  for (const bus::Vendor vendor : vendors) {
    const IdentityCheck check = check_identity(command.folder, vendor, std::time(nullptr));
    for (const Finding& finding : check.findings) {
      fmt::print("{}: {}\n", to_string(finding.severity), finding.sentence);
    }
    if (worst(check.findings) < Severity::error) {
      fmt::print("ok: {} over {}, until {} UTC\n", check.name, bus::to_string(vendor),
                 utc_text(check.end));
    }
    append(all, check.findings);
  }
  return worst(all) >= Severity::error ? problems_found : 0;
}

void add_show(CLI::App& command, FolderOptions& show) {
  command.add_option("FOLDER", show.folder, authority_help)->required();
}

Expected<void> run_show(const FolderOptions& show) {
  DYNCAL_TRY(const auto authority, LaboratoryAuthority::open(show.folder));
  DYNCAL_TRY(const auto issued, authority.issued());
  const std::time_t now = std::time(nullptr);
  fmt::print("{:<32} {:<10} {:<19} {}\n", "certificate", "DDS", "expires (UTC)", "state");
  for (const IssuedCertificate& one : issued) {
    fmt::print("{:<32} {:<10} {} {}\n", one.name, one.vendor, utc_text(one.end),
               one.revoked      ? "revoked"
               : one.end <= now ? "expired"
                                : "valid");
  }
  return {};
}

const Command security_command{72, "security", "who may take part in a secured laboratory"};
const Command init_command{73, "security init", "make the authority of a laboratory", add_init,
                           run_init};
const Command issue_command{74, "security issue", "make the folder of a program, for --security",
                            add_issue, run_issue};
const Command revoke_command{75, "security revoke", "revoke certificates", add_revoke, run_revoke};
const Command check_security_command{76, "security check",
                                     "what is wrong with the folder of a program",
                                     add_check_security, run_check_security};
const Command show_command{77, "security show", "list the certificates that were issued", add_show,
                           run_show};

} // namespace
} // namespace dyncal::inline programs
