#include "services/views/report/closures_csv.hpp"

#include <fmt/format.h>

#include "services/views/figures/figure.hpp"

namespace dyncal::inline views {
namespace {

std::string in_quotation_marks(std::string_view text) {
  std::string field = "\"";
  for (const char c : text) {
    field += c == '"' ? "\"\"" : std::string(1, c);
  }
  return field + "\"";
}

std::string line_of(const std::string& channel, const Closure& closure) {
  const auto number = [&](double value) {
    return closure.verdict == Verdict::not_possible ? "" : figures::csv_number(value);
  };
  return fmt::format("{},{},{},{},{},{},{},{},{},{}\n", in_quotation_marks(channel),
                     to_string(closure.kind), in_quotation_marks(title_of(closure.kind)),
                     in_quotation_marks(closure.subject), to_string(closure.verdict),
                     number(closure.value), number(closure.u), number(closure.limit),
                     in_quotation_marks(closure.unit), in_quotation_marks(closure.sentence));
}

} // namespace

std::string closures_csv(const RunOutcome& outcome) {
  std::string lines;
  for (const TransferFunction& function : outcome.transfer_functions) {
    for (const Closure& closure : function.closures) {
      lines += line_of(function.channel, closure);
    }
  }
  return lines.empty()
             ? ""
             : "channel,closure,title,compared,verdict,value,u,limit,unit,sentence\n" + lines;
}

} // namespace dyncal::inline views
