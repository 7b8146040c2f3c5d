#include "services/security/laboratory_authority.hpp"

#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/security/identity_check.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/x509_making.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

IdentityRequest request_of(SecurityRole role, const std::vector<std::string>& benches) {
  IdentityRequest request;
  request.role = role;
  request.benches = benches;
  request.vendors = bus::vendors_in_this_build();
  return request;
}

mode_t mode_of(const std::filesystem::path& path) {
  struct stat status {};
  EXPECT_EQ(stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 07777U;
}

class Authority : public testing::Test {
protected:
  tests::TemporaryFolder folder;
  std::filesystem::path place = folder.path() / "authority";
  Expected<LaboratoryAuthority> authority = LaboratoryAuthority::create(place, "Dynamics Lab");
};

TEST_F(Authority, IssuesFoldersWithNothingWrongForEveryRoleAndVendor) {
  ASSERT_TRUE(authority) << authority.error().message;
  int checked = 0;
  for (const SecurityRole role : security_roles()) {
    const auto output = folder.path() / to_string(role);
    const auto benches = is_of_a_bench(role) ? std::vector<std::string>{"acc-1", "shock & \"2\""}
                                             : std::vector<std::string>();
    const auto name = authority->issue(request_of(role, benches), output);
    ASSERT_TRUE(name) << name.error().message;
    for (const bus::Vendor vendor : bus::vendors_in_this_build()) {
      const auto check = check_identity(output, vendor, std::time(nullptr));
      EXPECT_THAT(check.findings, SizeIs(0)) << check.findings.front().sentence;
      EXPECT_EQ(check.name, *name);
      EXPECT_EQ(role_called(check.name), role);
      EXPECT_EQ(mode_of(security_files(output, vendor).private_key), 0600U);
      ++checked;
    }
    EXPECT_EQ(mode_of(output), 0700U);
  }
  EXPECT_GE(checked, 7);
}

TEST_F(Authority, GivesEveryVendorTheSubjectThatItNeeds) {
  ASSERT_TRUE(authority);
  for (int i = 0; i < 4; ++i) {
    const auto output = folder.path() / std::to_string(i);
    ASSERT_TRUE(authority->issue(request_of(SecurityRole::watcher, {}), output));
    for (const bus::Vendor vendor : bus::vendors_in_this_build()) {
      const auto certificates = read_certificates(security_files(output, vendor).certificate);
      ASSERT_TRUE(certificates);
      EXPECT_EQ(has_high_subject(*certificates->front()), bus::needs_high_subject(vendor));
    }
  }
}

TEST_F(Authority, NamesItsCertificatesAndListsAndRevokesThemByName) {
  ASSERT_TRUE(authority);
  const auto request = request_of(SecurityRole::source, {"acc-1"});
  EXPECT_EQ(authority->issue(request, folder.path() / "a"), "source-acc-1");
  EXPECT_EQ(authority->issue(request, folder.path() / "b"), "source-acc-1-2");
  ASSERT_TRUE(authority->revoke("source-acc-1"));
  ASSERT_TRUE(authority->revoke("source-acc-1")); // again
  const auto issued = authority->issued();
  ASSERT_TRUE(issued);
  ASSERT_THAT(*issued, SizeIs(2 * bus::vendors_in_this_build().size()));
  for (const IssuedCertificate& one : *issued) {
    EXPECT_EQ(one.revoked, one.name == "source-acc-1") << one.name;
  }
  const auto unknown = authority->revoke("source-acc-9");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("'source-acc-9'"));
  EXPECT_FALSE(authority->revoke("../ca"));
}

TEST_F(Authority, RefusesWhatDoesNotGoTogether) {
  ASSERT_TRUE(authority);
  EXPECT_FALSE(authority->issue(request_of(SecurityRole::source, {}), folder.path() / "a"));
  EXPECT_FALSE(authority->issue(request_of(SecurityRole::analysis, {"b"}), folder.path() / "b"));
  EXPECT_FALSE(authority->issue(request_of(SecurityRole::source, {"*"}), folder.path() / "c"));
  EXPECT_FALSE(authority->issue(request_of(SecurityRole::watcher, {}), place)); // not empty
  EXPECT_FALSE(LaboratoryAuthority::create(place, "Again"));
  EXPECT_FALSE(LaboratoryAuthority::create(folder.path() / "d", "a,b"));
}

TEST_F(Authority, ServesFromTheFilesOfOneThatIsThere) {
  ASSERT_TRUE(authority);
  const auto second = LaboratoryAuthority::create(
      folder.path() / "second", OwnAuthority{place / "ca.pem", place / "ca_key.pem"});
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_EQ(mode_of(folder.path() / "second" / "ca_key.pem"), 0600U);
  const auto output = folder.path() / "watcher";
  ASSERT_TRUE(second->issue(request_of(SecurityRole::watcher, {}), output));
  const auto check =
      check_identity(output, bus::vendors_in_this_build().front(), std::time(nullptr));
  EXPECT_THAT(check.findings, SizeIs(0));
  // Not a certificate that others may not be issued by.
  const auto files = security_files(output, bus::vendors_in_this_build().front());
  EXPECT_FALSE(LaboratoryAuthority::create(folder.path() / "third",
                                           OwnAuthority{files.certificate, files.private_key}));
}

} // namespace
} // namespace dyncal
