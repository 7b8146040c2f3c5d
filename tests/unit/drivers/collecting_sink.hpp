// Keeps what a driver delivers, for tests. One thread, unless a test locks around it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "drivers/sample_sink.hpp"

namespace dyncal::tests {

class CollectingSink : public drivers::SampleSink {
public:
  void describe(const drivers::SourceDescription& description) override {
    descriptions.push_back(description);
  }
  void begin_session() override { sessions_begun_at.push_back(blocks.size()); }
  void take(drivers::SampleBlock block) override {
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
  void count(const drivers::SampleCounts& now) override { counts = now; }
  void warn(const std::string& sentence) override { warnings.push_back(sentence); }

  // One channel over all blocks.
  [[nodiscard]] std::vector<double> channel(std::size_t index) const {
    std::vector<double> values;
    for (const drivers::SampleBlock& block : blocks) {
      const auto begin = block.values.begin() + static_cast<std::ptrdiff_t>(index * block.samples);
      values.insert(values.end(), begin, begin + static_cast<std::ptrdiff_t>(block.samples));
    }
    return values;
  }

  std::vector<drivers::SourceDescription> descriptions;
  std::vector<std::size_t> sessions_begun_at; // number of blocks before each session
  std::vector<drivers::SampleBlock> blocks;
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::uint64_t> numbers;
  drivers::SampleCounts counts; // the newest
  std::vector<std::string> warnings;
  std::function<void()> after_block;
};

} // namespace dyncal::tests
