// Messages of sources that runs have left out, by bench and source, since the service was started.
// Bounded: what has no room is counted under an empty name. One thread.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "services/daemon/supervision/daemon_metrics.hpp"

namespace dyncal::inline programs {

class LeftOutMessages {
public:
  static constexpr std::size_t max_sources = 1000;

  [[nodiscard]] LeftOutFigures& of(const std::string& bench, const std::string& source) {
    const auto known = std::ranges::find_if(figures_, [&](const LeftOutFigures& one) {
      return one.bench == bench && one.source == source;
    });
    if (known != figures_.end()) {
      return *known;
    }
    if (figures_.size() == max_sources) {
      return without_room_;
    }
    return figures_.emplace_back(LeftOutFigures{bench, source});
  }
  [[nodiscard]] std::vector<LeftOutFigures> figures() const {
    std::vector<LeftOutFigures> all = figures_;
    if (all.size() == max_sources) {
      all.push_back(without_room_);
    }
    return all;
  }

private:
  std::vector<LeftOutFigures> figures_;
  LeftOutFigures without_room_{};
};

} // namespace dyncal::inline programs
