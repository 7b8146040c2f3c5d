#include "services/bus/writer_instance.hpp"

#include <gtest/gtest.h>

namespace dyncal::bus {
namespace {

int hashed = 0;

KeyHash counted_hash(const std::string& canonical) {
  ++hashed;
  KeyHash hash{};
  hash[0] = static_cast<unsigned char>(canonical.size());
  return hash;
}

wire::SampleBlock block_of(const std::string& source, std::uint64_t number) {
  wire::SampleBlock block;
  block.bench("acc-1");
  block.source(source);
  block.block(number);
  return block;
}

class WriterInstanceTest : public testing::Test {
protected:
  WriterInstanceTest() { hashed = 0; }
  std::shared_ptr<const Instance> of(const wire::SampleBlock& block) {
    return instance_.of(*encode(block));
  }
  WriterInstance instance_{type_support<wire::SampleBlock>().key, &counted_hash};
};

TEST_F(WriterInstanceTest, IsHashedOnceForAllMessagesOfASource) {
  const auto first = of(block_of("dau", 0));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->key, (Key{{"acc-1", "dau"}, {}}));
  for (std::uint64_t number = 1; number < 10; ++number) {
    EXPECT_EQ(of(block_of("dau", number)), first);
  }
  EXPECT_EQ(hashed, 1);
}

// A name may begin as another one does, and be as long.
TEST_F(WriterInstanceTest, IsAnotherOneForAnotherKey) {
  const std::vector<std::string> names{"dau", "da", "dau2", "dav", "", "dau"};
  for (const std::string& name : names) {
    const auto instance = of(block_of(name, 0));
    ASSERT_TRUE(instance);
    EXPECT_EQ(instance->key.strings.back(), name);
    EXPECT_EQ(instance->hash, counted_hash(canonical_key(instance->key)));
  }
}

TEST_F(WriterInstanceTest, IsNoneForAKeyThatIsNotTheContracts) {
  ASSERT_TRUE(of(block_of("dau", 0)));
  EXPECT_EQ(instance_.of(""), nullptr);
  EXPECT_EQ(instance_.of(std::string(40, 'x')), nullptr);
  EXPECT_TRUE(of(block_of("dau", 1)));
}

} // namespace
} // namespace dyncal::bus
