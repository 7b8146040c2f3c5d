#include "services/security/revoked_participants.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/security/identity_folder.hpp"
#include "services/security/laboratory_authority.hpp"
#include "services/security/pem_file.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal::inline security {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RevokedParticipantsTest : public testing::Test {
protected:
  LaboratoryAuthority authority(const std::string& name) {
    auto made = LaboratoryAuthority::create(folder_.path() / name, "Lab");
    EXPECT_TRUE(made) << made.error().message;
    return std::move(*made);
  }
  // A writer of who has the certificate in this folder.
  bus::WriterId writer_of(const LaboratoryAuthority& authority, const std::string& folder) {
    const auto output = folder_.path() / folder;
    IdentityRequest request;
    request.role = SecurityRole::source;
    request.benches = {"acc-1"};
    request.vendors = {vendor_};
    const auto name = authority.issue(request, output);
    EXPECT_TRUE(name) << name.error().message;
    const auto certificates = read_certificates(security_files(output, vendor_).certificate);
    EXPECT_TRUE(certificates) << certificates.error().message;
    bus::WriterId writer;
    std::ranges::copy(guid_start_of(*X509_get_subject_name(certificates->front().get())),
                      writer.guid.begin());
    writer.guid.back() = 2;
    return writer;
  }
  void hand_out_list_of(const std::string& authority) {
    std::filesystem::copy_file(folder_.path() / authority / revoked_file,
                               folder_.path() / "own" / revoked_file,
                               std::filesystem::copy_options::overwrite_existing);
  }
  RevokedParticipants participants() {
    return {security_files(folder_.path() / "own", vendor_),
            [this](const std::string& sentence) { warnings_.push_back(sentence); },
            [this] { has_ended_ = true; }};
  }

  tests::TemporaryFolder folder_;
  bus::Vendor vendor_ = bus::vendors_in_this_build().front();
  std::vector<std::string> warnings_;
  bool has_ended_ = false;
  const RevokedParticipants::Instant begin_ = std::chrono::steady_clock::now();
};

TEST_F(RevokedParticipantsTest, AreThoseOfTheListAsItIsNow) {
  const auto lab = authority("lab");
  const auto own = writer_of(lab, "own");
  const auto other = writer_of(lab, "other");
  auto revoked = participants();
  EXPECT_FALSE(revoked.hold(other, begin_));
  EXPECT_FALSE(revoked.hold({}, begin_)) << "nobody is revoked";

  ASSERT_TRUE(lab.revoke("source-acc-1-2"));
  hand_out_list_of("lab");
  EXPECT_FALSE(revoked.hold(other, begin_ + 1s)) << "not looked at again";
  EXPECT_TRUE(revoked.hold(other, begin_ + 2s));
  EXPECT_TRUE(revoked.hold({}, begin_ + 2s)) << "it may be any";
  EXPECT_FALSE(revoked.hold(own, begin_ + 2s));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("has one of its 1 revoked certificates")));

  EXPECT_FALSE(has_ended_);
  ASSERT_TRUE(lab.revoke("source-acc-1"));
  hand_out_list_of("lab");
  EXPECT_TRUE(revoked.hold(own, begin_ + 4s));
  ASSERT_EQ(warnings_.size(), 3U);
  EXPECT_THAT(warnings_.back(), HasSubstr("own certificate is revoked"));
  EXPECT_TRUE(has_ended_);
}

TEST_F(RevokedParticipantsTest, StayWhenANewListIsNoneOfTheAuthority) {
  const auto lab = authority("lab");
  const auto foreign = authority("foreign");
  writer_of(lab, "own");
  const auto other = writer_of(lab, "other");
  ASSERT_TRUE(lab.revoke("source-acc-1-2"));
  hand_out_list_of("lab");
  auto revoked = participants();
  EXPECT_TRUE(revoked.hold(other, begin_));
  EXPECT_THAT(warnings_, IsEmpty()) << "the program began with it";

  hand_out_list_of("foreign");
  EXPECT_TRUE(revoked.hold(other, begin_ + 2s));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("the one before it goes on")));
  std::ofstream(folder_.path() / "own" / revoked_file) << "no list";
  EXPECT_TRUE(revoked.hold(other, begin_ + 4s));
  EXPECT_TRUE(revoked.hold(other, begin_ + 6s));
  EXPECT_EQ(warnings_.size(), 2U) << "each once";
  std::filesystem::remove(folder_.path() / "own" / revoked_file);
  EXPECT_TRUE(revoked.hold(other, begin_ + 8s));
  EXPECT_EQ(warnings_.size(), 3U);
}

} // namespace
} // namespace dyncal::inline security
