// Keeps what a driver delivers, for tests.
#pragma once

#include <functional>
#include <vector>

#include "drivers/acs/acs_driver.hpp"

namespace dyncal::drivers::acs {

class CollectingSink : public BlockSink {
public:
  void begin_session(const SourceDescription& description) override {
    sessions.push_back(description);
  }
  void take(SampleBlock block) override {
    for (std::size_t i = 0; i < block.samples; ++i) {
      stamps_ns.push_back(block.clock ? block.clock->stamp_ns(block.first_sample + i)
                                      : block.stamps_ns[i]);
      numbers.push_back(block.first_sample + i);
    }
    blocks.push_back(std::move(block));
    if (after_block) {
      after_block();
    }
  }
  // One channel over all blocks.
  [[nodiscard]] std::vector<double> channel(std::size_t index) const {
    std::vector<double> values;
    for (const SampleBlock& block : blocks) {
      const auto begin = block.values.begin() + static_cast<std::ptrdiff_t>(index * block.samples);
      values.insert(values.end(), begin, begin + static_cast<std::ptrdiff_t>(block.samples));
    }
    return values;
  }

  std::vector<SourceDescription> sessions;
  std::vector<SampleBlock> blocks;
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::uint64_t> numbers;
  std::function<void()> after_block;
};

} // namespace dyncal::drivers::acs
