// Does a result meet its tolerances? Every value of the channels against every row whose range of
// frequencies and levels it is in, both ends included: where two rows meet, both must be met.
//
//   deviation   100 (|H| / nominal - 1) %, 20 lg(|H| / nominal) dB, or phase - nominal in degrees,
//               within (-180, 180]; or the same from the value at a reference frequency, of the
//               same level and axis, whose U then counts in full: what both have in common is not
//               known to be the same at both frequencies
//   decision    analysis/response/conformity.hpp, limits in dB taken as limits of the ratio
//   undecided   a value without U, or with a flag that forbids a certificate (refusing_flags.hpp),
//               its own or that of its reference frequency; a planned point without a value
//
// Limits that cover no value and values that no limit covers are notes; a specification of which a
// limit was not measured is undecided as a whole, unless it fails. Values are judged with all their
// digits, not as rounded for people. Any thread.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "services/views/lab_file/tolerance_table.hpp"
#include "services/views/language/sentence.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct JudgedValue {
  static constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

  std::string channel{};
  std::string frequency_text_hz{};
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0; // as planned
  std::size_t row = 0;     // of the tolerances
  analysis::ConformityStatement statement = analysis::ConformityStatement::undecided;
  double deviation = nan_value; // in the unit of the row
  double expanded = nan_value;  // U of it
  double k = nan_value;
  double probability = nan_value; // of conformity
  TranslatedText reason{};        // why it is undecided, or what else is to be known
};

struct ConformityReport {
  Tolerances tolerances{};
  std::vector<JudgedValue> values{}; // by channel, row, frequency
  std::vector<TranslatedText> notes{};
  bool all_limits_measured = true;

  // Of all together: the worst of its values.
  [[nodiscard]] analysis::ConformityStatement statement() const;
};

[[nodiscard]] ConformityReport judge_conformity(const StoredResult& result,
                                                const std::vector<std::string>& channels,
                                                Tolerances tolerances);

} // namespace dyncal::inline views
