#include "services/programs/analysis/known_benches.hpp"

#include <numeric>

namespace dyncal::inline programs {

KnownSource* KnownBenches::heard(const std::string& bench, const std::string& source, Instant now) {
  KnownBench* known = bench_of(bench);
  if (known == nullptr || !has_room_for(source, bench, *known)) {
    return nullptr;
  }
  known->newest = now;
  known->heard[source] = now;
  return &known->sources[source];
}

KnownBenches::KnownBench* KnownBenches::bench_of(const std::string& name) {
  if (const auto known = benches_.find(name); known != benches_.end()) {
    return &known->second;
  }
  if (benches_.size() >= max_benches) {
    ++left_out_.benches;
    auto oldest = benches_.end();
    for (auto one = benches_.begin(); one != benches_.end(); ++one) {
      const bool is_older = oldest == benches_.end() || one->second.newest < oldest->second.newest;
      if (is_older && !in_use_.bench(one->first)) {
        oldest = one;
      }
    }
    if (oldest == benches_.end()) {
      return nullptr;
    }
    benches_.erase(oldest);
  }
  return &benches_[name];
}

bool KnownBenches::has_room_for(const std::string& source, const std::string& bench,
                                KnownBench& known) {
  if (known.sources.contains(source) || known.sources.size() < max_sources) {
    return true;
  }
  ++left_out_.sources;
  auto oldest = known.heard.end();
  for (auto one = known.heard.begin(); one != known.heard.end(); ++one) {
    const bool is_older = oldest == known.heard.end() || one->second < oldest->second;
    if (is_older && !in_use_.source(bench, one->first)) {
      oldest = one;
    }
  }
  if (oldest == known.heard.end()) {
    return false;
  }
  known.sources.erase(oldest->first);
  known.heard.erase(oldest);
  return true;
}

const KnownSources& KnownBenches::sources_of(const std::string& bench) const {
  static const KnownSources none;
  const auto known = benches_.find(bench);
  return known == benches_.end() ? none : known->second.sources;
}

std::size_t KnownBenches::sources() const {
  return std::accumulate(
      benches_.begin(), benches_.end(), std::size_t{0},
      [](std::size_t sum, const auto& bench) { return sum + bench.second.sources.size(); });
}

} // namespace dyncal::inline programs
