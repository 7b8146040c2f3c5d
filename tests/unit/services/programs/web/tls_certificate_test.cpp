#include "services/programs/web/tls_certificate.hpp"

#include <gtest/gtest.h>

#include "tests/temporary_folder.hpp"
#include "tests/unit/services/programs/web/tls_visitor.hpp"

namespace dyncal::inline programs::web {
namespace {

namespace fs = std::filesystem;

constexpr long year_s = 365L * 86'400;

class TlsCertificateTest : public testing::Test {
protected:
  static std::string refusal_of(const fs::path& certificate, const fs::path& key) {
    const auto read = TlsCertificate::read(certificate, key);
    return read ? "" : read.error().message;
  }

  tests::TemporaryFolder folder_;
  CertificateFiles page_ = make_certificate(folder_.path(), "page", year_s);
};

TEST_F(TlsCertificateTest, KnowsHowLongItIsValid) {
  const auto read = TlsCertificate::read(page_.certificate, page_.key);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->valid_until().size(), 10U);
  EXPECT_GE(read->valid_until(), "2026-01-01");
}

TEST_F(TlsCertificateTest, RefusesWhatNoBrowserWouldTakeByName) {
  const CertificateFiles other = make_certificate(folder_.path(), "other", year_s);
  const CertificateFiles old = make_certificate(folder_.path(), "old", 3600); // until yesterday
  const fs::path garbage = folder_.write("garbage.pem", "no certificate\n");
  fs::permissions(garbage, fs::perms::owner_read);
  struct Case {
    fs::path certificate;
    fs::path key;
    const char* named;
    const char* reason;
  };
  const Case cases[] = {
      {folder_.path() / "nowhere.pem", page_.key, "nowhere.pem", "can be read"},
      {garbage, page_.key, "garbage.pem", "no certificate in PEM"},
      {page_.certificate, folder_.path() / "no-key.pem", "no-key.pem", "can be read"},
      {page_.certificate, garbage, "garbage.pem", "no key of"},
      {page_.certificate, other.key, "other-key.pem", "mismatch"},
      {old.certificate, old.key, "old.pem", "was valid until"},
  };
  for (const auto& [certificate, key, named, reason] : cases) {
    const std::string refusal = refusal_of(certificate, key);
    EXPECT_NE(refusal.find(named), std::string::npos) << refusal;
    EXPECT_NE(refusal.find(reason), std::string::npos) << refusal;
  }
}

TEST_F(TlsCertificateTest, RefusesAKeyThatEverybodyMayRead) {
  fs::permissions(page_.key, fs::perms::others_read, fs::perm_options::add);
  EXPECT_NE(refusal_of(page_.certificate, page_.key).find("chmod o="), std::string::npos);
}

} // namespace
} // namespace dyncal::inline programs::web
