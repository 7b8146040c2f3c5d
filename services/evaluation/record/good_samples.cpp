#include "services/evaluation/record/good_samples.hpp"

namespace dyncal::inline evaluation {

void push_good_samples(const SourceRecord& record, std::size_t channel, const SampleRange& range,
                       analysis::ExcitationWindowFinder& finder) {
  const auto stamps = record.stamps_ns();
  const auto flags = record.flags();
  const auto values = record.column(channel);
  const auto good = [&](std::size_t i) {
    return flags[i] == 0 && stamps[i] >= range.begin_ns && stamps[i] < range.end_ns;
  };
  for (std::size_t i = range.first; i < stamps.size();) {
    const std::size_t begin = i;
    while (i < stamps.size() && good(i)) {
      ++i;
    }
    finder.push(stamps.subspan(begin, i - begin), values.subspan(begin, i - begin));
    while (i < stamps.size() && !good(i)) {
      ++i;
    }
  }
}

} // namespace dyncal::inline evaluation
