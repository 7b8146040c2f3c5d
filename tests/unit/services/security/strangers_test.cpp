// Who is there and may not be talked to, by what DDS discovery tells.
#include "services/security/strangers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/security/identity_folder.hpp"
#include "services/security/laboratory_authority.hpp"
#include "services/security/revoked_participants.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string plain = "0110aabbccddeeff00112233";
const std::string secured = "9110aabbccddeeff00112233";

std::vector<std::string> ids_of(const std::vector<Stranger>& strangers) {
  std::vector<std::string> ids;
  for (const Stranger& one : strangers) {
    ids.push_back(one.id);
  }
  return ids;
}

bus::Discovery found(const std::vector<std::string>& ids, const std::string& with_endpoint = "") {
  bus::Discovery discovery;
  for (const std::string& id : ids) {
    discovery.participants.push_back({id, "dyncal-acs:7 on lab-2", "Cyclone DDS"});
  }
  if (!with_endpoint.empty()) {
    bus::DiscoveredEndpoint endpoint;
    endpoint.participant = with_endpoint;
    discovery.endpoints.push_back(endpoint);
  }
  return discovery;
}

TEST(Strangers, AreThoseWhoShowNoEndpointForSoLong) {
  StrangerWatch watch;
  const auto begin = std::chrono::steady_clock::now();
  watch.look(found({plain, secured}), begin);
  EXPECT_THAT(ids_of(watch.strangers(1s)), IsEmpty());
  watch.look(found({plain, secured}, secured), begin + 2s);
  EXPECT_THAT(ids_of(watch.strangers(1s)), ElementsAre(plain));
  watch.look(found({plain, secured}, secured), begin + 4s);
  EXPECT_THAT(ids_of(watch.strangers(1s)), ElementsAre(plain));
}

TEST(Strangers, MayBeMissingInALookAndAreForgottenWhenTheyAreGone) {
  StrangerWatch watch;
  const auto begin = std::chrono::steady_clock::now();
  watch.look(found({plain}), begin);
  watch.look(found({}), begin + 1s);
  EXPECT_THAT(ids_of(watch.strangers(1s)), IsEmpty()) << "it was seen once";
  watch.look(found({plain}), begin + 2s);
  watch.look(found({}), begin + 3s);
  EXPECT_THAT(ids_of(watch.strangers(1s)), ElementsAre(plain));
  watch.look(found({}), begin + 3s + StrangerWatch::forgotten_after);
  EXPECT_THAT(ids_of(watch.strangers(1s)), IsEmpty());
}

TEST(Strangers, AreBoundedHoweverManyAnnounceThemselves) {
  StrangerWatch watch;
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < 2 * StrangerWatch::max_strangers; ++i) {
    watch.look(found({std::to_string(i)}), begin);
  }
  EXPECT_EQ(watch.strangers(0s).size(), StrangerWatch::max_strangers);
}

TEST(Strangers, AreNamedWithWhatIsKnownOfTheReason) {
  EXPECT_EQ(strangers_sentence({}, "nowhere"), "");
  EXPECT_EQ(strangers_sentence({{plain, "dyncal-acs:7 on lab-2"}}, "nowhere"),
            "1 program is here that this program may not talk to: dyncal-acs:7 on lab-2 (without "
            "--security)");
  EXPECT_EQ(strangers_sentence({{secured, ""}, {secured, "x", "of another governance"}}, "nowhere"),
            "2 programs are here that this program may not talk to: " + secured +
                " (of another authority or governance, or expired), x (of another governance)");
  EXPECT_THAT(strangers_sentence(std::vector<Stranger>(9, {plain, "x"}), "nowhere"),
              HasSubstr(", and 5 more"));
}

TEST(Strangers, AreKnownToBeRevokedByTheList) {
  const tests::TemporaryFolder folder;
  const auto authority = LaboratoryAuthority::create(folder.path() / "authority", "Lab");
  ASSERT_TRUE(authority) << authority.error().message;
  IdentityRequest request;
  request.role = SecurityRole::analysis;
  request.vendors = {bus::vendors_in_this_build().front()};
  ASSERT_TRUE(authority->issue(request, folder.path() / "own"));
  const auto start = own_guid_start(folder.path() / "own", request.vendors.front());
  ASSERT_TRUE(start);
  const Stranger stranger{bus::hexadecimal(start->data(), start->size()) + "000102030405", "x"};
  const auto list = folder.path() / "authority" / revoked_file;
  EXPECT_THAT(strangers_sentence({stranger}, list), HasSubstr("x (of another authority"));
  ASSERT_TRUE(authority->revoke("analysis"));
  EXPECT_THAT(strangers_sentence({stranger}, list), HasSubstr("x (revoked)"));
  EXPECT_THAT(authority_of(folder.path() / "own"), HasSubstr("/O=Lab/OU="));
  EXPECT_EQ(authority_of("nowhere"), "");
}

} // namespace
} // namespace dyncal
