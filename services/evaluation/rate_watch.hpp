// Notices, from the first blocks of every source, that it samples too slowly for a planned
// frequency, where its description states no rate: live, before such a step is excited again and
// again for nothing.
//
// The rate is the median over 16 blocks of samples per time from one block to the next, by the
// numbers of the samples, so that a lost block or one step of the clock does not change it.
// It counts as too slow where a frequency is above half of it by more than its own uncertainty.
//
// Belongs to one thread; the recipe must outlive it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/contract/source_block.hpp"
#include "services/evaluation/recipe/recipe.hpp"

namespace dyncal::inline evaluation {

class RateWatch {
public:
  // Above half the rate by this part: clocks are right to 1e-3, stamps of single blocks to 1e-2.
  static constexpr double margin_rel = 0.01;

  explicit RateWatch(const Recipe& recipe);

  void add(const std::string& source, const SourceBlock& block);
  // One sentence, once there is something to say.
  [[nodiscard]] const std::optional<std::string>& problem() const { return problem_; }

private:
  struct Seen { // of a source whose rate is not known yet
    std::uint64_t session = 0;
    std::uint64_t first_sample = 0;
    std::int64_t first_stamp_ns = 0;
    std::vector<double> rates_hz;
  };

  void judge(const std::string& source, double rate_hz);

  const Recipe& recipe_;
  std::map<std::string, Seen> unknown_;
  std::optional<std::string> problem_;
};

} // namespace dyncal::inline evaluation
