// Any text as the table of a calibration system: it is read, or refused with the file and line;
// rows are as their format says, and a file that is written to never gives a row that the whole
// file does not have.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "drivers/tables/row_alignment.hpp"
#include "drivers/tables/table_match.hpp"

namespace {

using namespace dyncal::drivers;
using namespace dyncal::drivers::tables;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

void check_rows(const std::vector<ReferenceTableRow>& rows) {
  std::size_t line = 0;
  for (const ReferenceTableRow& row : rows) {
    require(row.line > line && row.frequency_hz > 0.0 && row.amplitude_m_s2 > 0.0 &&
            std::isfinite(row.phase_deg));
    line = row.line;
  }
}

// Whatever the rows are, a step has a row of its own frequency, and no row is of two steps.
void check_match(const std::vector<ReferenceTableRow>& rows) {
  const TableFile file{.name = "t", .rows = rows};
  const PlannedRow plan[] = {{1, 10.0}, {1, 80.0}, {1, 80.0}, {2, 10.0}, {2, 80.0}, {2, 80.0}};
  const auto match = match_table({&file, 1}, plan, {.paths = {}, .skip_first_rows = 1});
  if (!match) {
    return;
  }
  for (std::size_t i = 0; i < match->steps.size(); ++i) {
    const ReferenceTableRow* row = match->steps[i].at.row;
    require((row == nullptr) != match->steps[i].problem.empty());
    require(row == nullptr || std::abs(row->frequency_hz - plan[i].frequency_hz) <=
                                  same_frequency_rel * plan[i].frequency_hz);
    for (std::size_t k = 0; k < i; ++k) {
      require(row == nullptr || match->steps[k].at.row != row);
    }
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto whole = parse_reference_table("t", text);
  const auto coming = parse_reference_table("t", text, {}, TableIs::written_to);
  if (!whole) {
    require(whole.error().message.starts_with("t: line "));
    require(whole.error().message.find("; expected ") != std::string::npos);
  } else {
    check_rows(*whole);
    require(coming.has_value() && *coming == *whole);
    check_match(*whole);
  }
  for (const TableFormat format :
       {TableFormat::ptb_csv, TableFormat::spektra_csv, TableFormat::spektra_prp}) {
    if (const auto rows = parse_reference_table("t", text, format)) {
      check_rows(*rows);
    }
  }
  return 0;
}
