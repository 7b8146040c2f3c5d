// That every link of a chain counts once and in order, and that nothing else does.
#include "services/contract/one_way_chain.hpp"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "services/contract/digest.hpp"

namespace dyncal::inline contract {
namespace {

ChainLink drawn(std::mt19937_64& random) {
  ChainLink link;
  for (unsigned char& byte : link) {
    byte = static_cast<unsigned char>(random());
  }
  return link;
}

std::vector<NumberedLink> all_of(OneWayChain& chain) {
  std::vector<NumberedLink> links;
  while (const auto link = chain.next()) {
    links.push_back(*link);
  }
  return links;
}

TEST(OneWayChain, ShowsEveryLinkFromTheAnnouncedOneToTheSecret) {
  std::mt19937_64 random(1);
  for (const std::uint64_t length : {1U, 2U, 3U, 4U, 15U, 16U, 17U, 99U, 1000U}) {
    const ChainLink secret = drawn(random);
    OneWayChain chain(secret, length);
    const auto links = all_of(chain);
    ASSERT_EQ(links.size(), length);
    ChainLink before = chain.announced();
    for (std::size_t i = 0; i < length; ++i) {
      EXPECT_EQ(links[i].number, i + 1);
      Digest digest;
      digest.add(links[i].link.data(), links[i].link.size());
      EXPECT_EQ(digest.hex(), to_string(before)) << length << ": " << i;
      before = links[i].link;
    }
    EXPECT_EQ(before, secret);
    EXPECT_FALSE(chain.next());
  }
}

TEST(OneWayChain, DrawsAnotherSecretEveryTime) {
  EXPECT_NE(OneWayChain::draw(3)->announced(), OneWayChain::draw(3)->announced());
}

TEST(ChainFollower, TakesEachLinkOnceAndGoesOnAfterLostOnes) {
  std::mt19937_64 random(2);
  OneWayChain chain(drawn(random), 500);
  ChainFollower follower({0, chain.announced()});
  const auto links = all_of(chain);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < links.size(); i += 1 + random() % 5) {
    EXPECT_TRUE(follower.accept(links[i], 8)) << i;
    EXPECT_FALSE(follower.accept(links[i], 8)) << "a replay of link " << i;
    EXPECT_FALSE(follower.accept(links[random() % (i + 1)], 8)) << "an older one than " << i;
    ++taken;
  }
  EXPECT_GT(taken, 100U);
}

TEST(ChainFollower, TakesNothingThatIsInvented) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::mt19937_64 random(seed);
    OneWayChain chain(drawn(random), 100);
    OneWayChain other(drawn(random), 100);
    ChainFollower follower({0, chain.announced()});
    const auto links = all_of(chain);
    const auto others = all_of(other);
    ASSERT_TRUE(follower.accept(links[40], 100));
    EXPECT_FALSE(follower.accept({links[40].number + 1, drawn(random)}, 100));
    EXPECT_FALSE(follower.accept({links[40].number + 1, links[40].link}, 100));
    EXPECT_FALSE(follower.accept({links[39].number + 5, links[39].link}, 100));
    EXPECT_FALSE(follower.accept({links[45].number - 1, links[45].link}, 100));
    EXPECT_FALSE(follower.accept({links[45].number + 1, links[45].link}, 100));
    EXPECT_FALSE(follower.accept(others[41], 100));
    ChainLink changed = links[41].link;
    changed[random() % changed.size()] ^= static_cast<unsigned char>(1U << random() % 8);
    EXPECT_FALSE(follower.accept({links[41].number, changed}, 100));
    EXPECT_EQ(follower.latest(), links[40]);
    EXPECT_TRUE(follower.accept(links[41], 100));
  }
}

TEST(ChainFollower, HashesNoMoreLinksThanItIsAllowed) {
  std::mt19937_64 random(3);
  OneWayChain chain(drawn(random), 100);
  ChainFollower follower({0, chain.announced()});
  const auto links = all_of(chain);
  EXPECT_FALSE(follower.accept(links[10], 10));
  EXPECT_FALSE(follower.accept({~std::uint64_t{0}, links[10].link}, 10));
  EXPECT_TRUE(follower.accept(links[10], 11));
}

TEST(ChainLink, IsReadAsItWasWritten) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 100; ++i) {
    const ChainLink link = drawn(random);
    EXPECT_EQ(parse_chain_link(to_string(link)), link);
  }
  const std::string right = to_string(drawn(random));
  for (const std::string& wrong :
       {std::string(), right.substr(1), right + "0", "g" + right.substr(1), "-" + right.substr(1),
        " " + right.substr(1)}) {
    EXPECT_FALSE(parse_chain_link(wrong)) << wrong;
  }
}

} // namespace
} // namespace dyncal::inline contract
