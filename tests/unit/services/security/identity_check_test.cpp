// Each thing that can be wrong with the folder of a program is refused with a sentence, before the
// program joins.
#include "services/security/identity_check.hpp"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/ec.h>
#include <openssl/rsa.h>

#include "services/base/output_file.hpp"
#include "services/base/whole_file.hpp"
#include "services/security/access_documents.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/laboratory_authority.hpp"
#include "services/security/signed_document.hpp"
#include "services/security/x509_making.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::time_t day = 86400;

class IdentityCheckOf : public testing::TestWithParam<bus::Vendor> {
protected:
  void SetUp() override {
    ASSERT_TRUE(LaboratoryAuthority::create(authority, "Lab"));
    issue(authority, output, SecurityRole::source);
  }
  void issue(const fs::path& by, const fs::path& to, SecurityRole role) {
    const auto opened = LaboratoryAuthority::open(by);
    ASSERT_TRUE(opened) << opened.error().message;
    IdentityRequest request;
    request.role = role;
    request.benches =
        is_of_a_bench(role) ? std::vector<std::string>{"acc-1"} : std::vector<std::string>();
    request.vendors = bus::speaks_alone_when_secured(GetParam()) ? std::vector{GetParam()}
                                                                 : bus::vendors_in_this_build();
    const auto name = opened->issue(request, to);
    ASSERT_TRUE(name) << name.error().message;
  }
  // The sentence that `program` ends with; empty: it joins.
  [[nodiscard]] std::string refusal(const std::string& program = "dyncal-dau",
                                    std::time_t after = 0) const {
    const auto outcome = require_identity(output, GetParam(), program, std::time(nullptr) + after);
    return outcome ? "" : outcome.error().message;
  }
  [[nodiscard]] OpenSslPointer<X509> authority_certificate() const {
    auto all = read_certificates(authority / "ca.pem");
    return all ? std::move(all->front()) : nullptr;
  }
  [[nodiscard]] OpenSslPointer<EVP_PKEY> authority_key() const {
    auto key = read_private_key(authority / "ca_key.pem");
    return key ? std::move(*key) : nullptr;
  }
  // In place of the certificate, with this key and subject.
  void replace_certificate(EVP_PKEY& key, bool high) {
    const auto ca = authority_certificate();
    const auto ca_key = authority_key();
    const auto now = std::time(nullptr);
    const Validity validity{now - day, now + 365 * day};
    const auto certificate =
        make_certificate({"Lab", "source-acc-1", high, validity}, key, *ca, *ca_key);
    ASSERT_TRUE(certificate);
    ASSERT_TRUE(write_output_file(files().certificate, pem_text(*certificate)));
    fs::remove(files().private_key);
    ASSERT_TRUE(write_output_file(files().private_key, pem_text(key)));
    fs::permissions(files().private_key, fs::perms::owner_read);
    sign_again(files().permissions, permissions_text(subject_text(*certificate), validity,
                                                     SecurityRole::source, {"acc-1"}));
  }
  void sign_again(const fs::path& file, const std::string& text) const {
    const auto signed_text = sign_document(text, *authority_certificate(), *authority_key());
    ASSERT_TRUE(signed_text);
    ASSERT_TRUE(write_output_file(file, *signed_text));
  }
  [[nodiscard]] std::string text_of(const fs::path& file) const {
    return read_signed_document(file, *authority_certificate()).value_or("");
  }
  [[nodiscard]] bus::SecurityFiles files() const { return security_files(output, GetParam()); }

  tests::TemporaryFolder folder;
  fs::path authority = folder.path() / "authority";
  fs::path output = folder.path() / "dau";
};

TEST_P(IdentityCheckOf, HasNothingToSayOfAFolderThatIsRight) {
  EXPECT_EQ(refusal(), "");
  EXPECT_TRUE(require_validity(output, GetParam(), std::chrono::hours(24), std::time(nullptr)));
}

TEST_P(IdentityCheckOf, RefusesNoCertificate) {
  fs::remove(files().certificate);
  EXPECT_THAT(refusal(), HasSubstr(files().certificate.string()));
  fs::remove_all(output);
  EXPECT_NE(refusal(), "");
}

TEST_P(IdentityCheckOf, RefusesAForeignAuthorityOfTheSameSubject) {
  const auto ca = authority_certificate();
  const auto key = make_private_key();
  const OpenSslPointer<X509> foreign(X509_dup(ca.get()));
  X509_set_pubkey(foreign.get(), key.get());
  X509_sign(foreign.get(), key.get(), EVP_sha256());
  ASSERT_TRUE(write_output_file(output / "ca.pem", pem_text(*foreign)));
  EXPECT_THAT(refusal(), HasSubstr("was not issued by the authority"));
}

TEST_P(IdentityCheckOf, RefusesAnotherRoleThanTheProgramNeeds) {
  EXPECT_THAT(refusal("dyncal-analysis"), HasSubstr("not of the role 'analysis'"));
  EXPECT_THAT(refusal("dyncal-run"), HasSubstr("not of the role 'operator'"));
  EXPECT_EQ(refusal("dyncal-watch"), "");
}

TEST_P(IdentityCheckOf, RefusesWhatWasRevoked) {
  const auto opened = LaboratoryAuthority::open(authority);
  ASSERT_TRUE(opened);
  ASSERT_TRUE(opened->revoke("source-acc-1"));
  EXPECT_EQ(refusal(), ""); // the folder has the list of before
  fs::copy_file(authority / "revoked.pem", output / "revoked.pem",
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(refusal(), HasSubstr("has been revoked"));
}

TEST_P(IdentityCheckOf, RefusesWhatHasExpiredOrDoesNotLastARun) {
  EXPECT_THAT(refusal("dyncal-dau", 366 * day), HasSubstr("expired at 20"));
  EXPECT_THAT(refusal("dyncal-dau", -2 * day), HasSubstr("does the clock of this host go right"));
  const auto lasts = require_validity(output, GetParam(), std::chrono::hours(2),
                                      std::time(nullptr) + 365 * day - 3600);
  ASSERT_FALSE(lasts);
  EXPECT_THAT(lasts.error().message, HasSubstr("before the end of the run, which takes 120 min"));
}

TEST_P(IdentityCheckOf, WarnsAMonthBefore) {
  const auto check = check_identity(output, GetParam(), std::time(nullptr) + 340 * day);
  EXPECT_EQ(worst(check.findings), Severity::warning);
}

TEST_P(IdentityCheckOf, RefusesPermissionsOfAnother) {
  const auto other = folder.path() / "other";
  issue(authority, other, SecurityRole::analysis);
  fs::copy_file(security_files(other, GetParam()).permissions, files().permissions,
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(refusal(), HasSubstr("are those of another certificate"));
}

TEST_P(IdentityCheckOf, RefusesPermissionsThatWereChanged) {
  std::string text = base::read_whole_file(files().permissions, 1U << 20U).value_or("");
  const auto at = text.find("acc-1");
  ASSERT_NE(at, std::string::npos);
  text[at + 4] = '2';
  ASSERT_TRUE(write_output_file(files().permissions, text));
  EXPECT_THAT(refusal(), HasSubstr("is not signed by the authority"));
}

TEST_P(IdentityCheckOf, RefusesPermissionsWithoutPartitions) {
  std::string text = text_of(files().permissions);
  const auto begin = text.find("<partitions>");
  const std::string end = "</partitions>";
  ASSERT_NE(begin, std::string::npos);
  text.erase(begin, text.find(end) + end.size() - begin);
  sign_again(files().permissions, text);
  EXPECT_THAT(refusal(), HasSubstr("names no partition"));
}

TEST_P(IdentityCheckOf, RefusesAnotherGovernance) {
  std::string text = text_of(files().governance);
  const std::string encrypted = "<metadata_protection_kind>ENCRYPT";
  const auto at = text.find(encrypted);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, encrypted.size(), "<metadata_protection_kind>NONE");
  sign_again(files().governance, text);
  EXPECT_THAT(refusal(), HasSubstr("metadata_protection_kind is NONE, not ENCRYPT"));
}

TEST_P(IdentityCheckOf, RefusesKeysOfAnotherKind) {
  const OpenSslPointer<EVP_PKEY> key(EVP_EC_gen("P-384"));
  replace_certificate(*key, bus::needs_high_subject(GetParam()));
  EXPECT_THAT(refusal(), HasSubstr("has a key of another kind than P-256"));
  const OpenSslPointer<EVP_PKEY> rsa(EVP_RSA_gen(2048));
  replace_certificate(*rsa, bus::needs_high_subject(GetParam()));
  EXPECT_EQ(refusal(), "");
}

TEST_P(IdentityCheckOf, RefusesTheSubjectOfTheOtherVendor) {
  const auto key = make_private_key();
  replace_certificate(*key, !bus::needs_high_subject(GetParam()));
  EXPECT_THAT(refusal(), HasSubstr("SHA-256 of its subject begins with"));
}

TEST_P(IdentityCheckOf, RefusesAKeyThatOthersCanReadOrThatIsOfAnother) {
  fs::permissions(files().private_key, fs::perms::others_read, fs::perm_options::add);
  EXPECT_THAT(refusal(), HasSubstr("can be read by others (mode 0604): chmod 600"));
  fs::remove(files().private_key);
  ASSERT_TRUE(write_output_file(files().private_key, pem_text(*make_private_key())));
  fs::permissions(files().private_key, fs::perms::owner_read);
  EXPECT_THAT(refusal(), HasSubstr("is not the key of the certificate"));
}

TEST_P(IdentityCheckOf, ReadsAFolderAsASystemHandsItOnBesideAnother) {
  const fs::path handed_on = folder.path() / "run";
  for (const auto& file : fs::directory_iterator(output)) {
    fs::rename(file, handed_on.string() + "_" + file.path().filename().string());
  }
  EXPECT_NE(refusal(), "");
  const auto outcome = require_identity(handed_on, GetParam(), "dyncal-dau", std::time(nullptr));
  EXPECT_TRUE(outcome) << outcome.error().message;
}

TEST_P(IdentityCheckOf, RefusesAFolderForAMixedLaboratoryWhereTheVendorSpeaksAlone) {
  if (bus::vendors_in_this_build().size() == 1) {
    GTEST_SKIP() << "a build with one DDS implementation mixes none";
  }
  const auto opened = LaboratoryAuthority::open(authority);
  ASSERT_TRUE(opened) << opened.error().message;
  IdentityRequest request;
  request.role = SecurityRole::analysis;
  request.vendors = bus::vendors_in_this_build();
  ASSERT_TRUE(opened->issue(request, folder.path() / "mixed"));
  request.vendors = {GetParam()};
  ASSERT_TRUE(opened->issue(request, folder.path() / "alone"));
  const auto mixed = require_no_other_vendor(folder.path() / "mixed", GetParam());
  ASSERT_FALSE(mixed);
  EXPECT_THAT(mixed.error().message, HasSubstr("talks to no other DDS once it is secured"));
  EXPECT_TRUE(require_no_other_vendor(folder.path() / "alone", GetParam()));
}

INSTANTIATE_TEST_SUITE_P(EveryVendor, IdentityCheckOf,
                         testing::ValuesIn(bus::vendors_in_this_build()),
                         [](const auto& one) { return bus::to_string(one.param); });

} // namespace
} // namespace dyncal
