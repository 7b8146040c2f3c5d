// Closed sets as words, as result files have them: refused with a sentence where a word is none of
// them.
#pragma once

#include <string>
#include <string_view>

#include "analysis/uncertainty/contribution.hpp"
#include "failure.hpp"

namespace dyncal::python {

inline analysis::Distribution distribution_of(const std::string& word) {
  const auto distribution = analysis::parse_distribution(word);
  if (!distribution) {
    refuse("distribution is '" + word +
           "', but must be 'normal', 'rectangular', 'triangular' or 'arcsine'");
  }
  return *distribution;
}

constexpr std::string_view word_of(analysis::Repeats repeats) {
  switch (repeats) {
  case analysis::Repeats::anew:
    return "anew";
  case analysis::Repeats::common:
    return "common";
  case analysis::Repeats::common_delay:
    return "common_delay";
  }
  return "common";
}

inline analysis::Repeats repeats_named(const std::string& word) {
  using analysis::Repeats;
  for (const Repeats repeats : {Repeats::anew, Repeats::common, Repeats::common_delay}) {
    if (word == word_of(repeats)) {
      return repeats;
    }
  }
  refuse("repeats is '" + word + "', but must be 'anew', 'common' or 'common_delay'");
}

} // namespace dyncal::python
