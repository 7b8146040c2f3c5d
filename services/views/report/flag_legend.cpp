#include "services/views/report/flag_legend.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

void append(const std::vector<Flag>& from, std::vector<Flag>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

void add_once(std::vector<std::string>& texts, const std::string& text) {
  if (std::find(texts.begin(), texts.end(), text) == texts.end()) {
    texts.push_back(text);
  }
}

} // namespace

std::vector<StoredFlag> flag_legend(const std::vector<Flag>& flags) {
  std::map<ResultFlag, StoredFlag> by_kind;
  for (const Flag& flag : flags) {
    StoredFlag& meaning = by_kind[flag.kind];
    meaning.name = name_of(flag.kind);
    meaning.meaning = explanation_of(flag.kind);
    add_once(meaning.sentences, flag.sentence);
  }
  std::vector<StoredFlag> legend;
  legend.reserve(by_kind.size());
  for (auto& [kind, meaning] : by_kind) {
    legend.push_back(std::move(meaning));
  }
  return legend;
}

std::vector<StoredFlag> legend_of_channels(const StoredResult& result,
                                           const std::vector<std::string>& channels) {
  std::set<std::string> names;
  std::set<std::string> said;
  const auto take = [&](const std::vector<std::string>& of, const std::vector<std::string>& how) {
    names.insert(of.begin(), of.end());
    said.insert(how.begin(), how.end());
  };
  for (const std::string& channel : channels) {
    for (const StoredValue& value : result.values_of(channel)) {
      take(value.flag_names, value.flags);
    }
    for (const StoredPoint& point : result.points_of(channel)) {
      take(point.flag_names, point.sentences);
    }
    for (const StoredChannel& whole : result.channels) {
      if (whole.channel == channel) {
        take(whole.flag_names, whole.flags);
      }
    }
  }
  std::vector<StoredFlag> legend;
  for (StoredFlag flag : result.flags) {
    if (names.contains(flag.name)) {
      std::erase_if(flag.sentences, [&](const std::string& one) { return !said.contains(one); });
      legend.push_back(std::move(flag));
    }
  }
  return legend;
}

std::string legend_line(const StoredFlag& meaning) {
  constexpr std::size_t max_sentences = 3;
  return fmt::format("{} ({}): {}", meaning.name,
                     fmt::join(first_of(meaning.sentences, max_sentences), "; "), meaning.meaning);
}

std::vector<Flag> flags_of(const RunOutcome& outcome) {
  std::vector<Flag> flags;
  for (const StepResult& result : outcome.results) {
    append(result.flags, flags);
  }
  for (const TransferFunction& function : outcome.transfer_functions) {
    append(function.flags, flags);
  }
  for (const ClockReport& report : outcome.clock_reports) {
    append(report.flags, flags);
  }
  return flags;
}

std::vector<Flag> flags_of(const RunOutcome& outcome, const TransferFunction& function) {
  std::vector<Flag> flags = function.flags;
  for (const StepResult& result : outcome.results) {
    if (result.valid && result.channel == function.channel) {
      append(result.flags, flags);
    }
  }
  return flags;
}

std::vector<Flag> flags_of(const RunOutcome& outcome, const std::string& channel,
                           const FrequencyPoint& point) {
  std::vector<Flag> flags;
  for (const StepResult& result : outcome.results) {
    if (result.valid && result.channel == channel && result.frequency_hz == point.frequency_hz &&
        result.level_m_s2 == point.level_m_s2) {
      append(result.flags, flags);
    }
  }
  return flags;
}

std::vector<Flag> flags_once(const std::vector<Flag>& flags) {
  std::vector<Flag> once;
  for (const Flag& flag : flags) {
    if (std::find(once.begin(), once.end(), flag) == once.end()) {
      once.push_back(flag);
    }
  }
  return once;
}

std::string flag_names(const std::vector<Flag>& flags) {
  std::vector<std::string> names;
  for (const Flag& flag : flags) {
    add_once(names, std::string(name_of(flag.kind)));
  }
  return fmt::format("{}", fmt::join(names, " "));
}

} // namespace dyncal::inline views
