#include "services/views/spreadsheet/means_workbook.hpp"

#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <xlsxwriter.h>

namespace dyncal::inline views {
namespace {

// The formats of a workbook by decimals: "0.00".
class Formats {
public:
  explicit Formats(lxw_workbook* workbook) : workbook_(workbook) {}

  lxw_format* with(int decimals) {
    if (decimals < 0) {
      return nullptr;
    }
    auto [found, is_new] = formats_.try_emplace(decimals, nullptr);
    if (is_new) {
      found->second = workbook_add_format(workbook_);
      const std::string text = decimals == 0 ? "0" : "0." + std::string(decimals, '0');
      format_set_num_format(found->second, text.c_str());
    }
    return found->second;
  }

private:
  lxw_workbook* workbook_;
  std::map<int, lxw_format*> formats_;
};

void write_means(lxw_workbook* workbook, const MeansTable& table) {
  lxw_worksheet* const sheet = workbook_add_worksheet(workbook, "means");
  lxw_format* const bold = workbook_add_format(workbook);
  format_set_bold(bold);
  Formats formats(workbook);
  for (std::size_t column = 0; column < table.head.size(); ++column) {
    worksheet_write_string(sheet, 0, static_cast<lxw_col_t>(column), table.head[column].c_str(),
                           bold);
  }
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const auto row = static_cast<lxw_row_t>(i + 1);
    for (std::size_t j = 0; j < table.rows[i].size(); ++j) {
      const auto column = static_cast<lxw_col_t>(j);
      if (const auto* text = std::get_if<std::string>(&table.rows[i][j])) {
        worksheet_write_string(sheet, row, column, text->c_str(), nullptr);
      } else if (const auto& cell = std::get<NumberCell>(table.rows[i][j]);
                 std::isfinite(cell.value)) {
        worksheet_write_number(sheet, row, column, cell.value, formats.with(cell.decimals));
      }
    }
  }
  worksheet_freeze_panes(sheet, 1, 0);
}

void write_run(lxw_workbook* workbook, const StoredResult& result) {
  lxw_worksheet* const sheet = workbook_add_worksheet(workbook, "run");
  const std::pair<const char*, const std::string&> lines[] = {
      {"bench", result.bench},
      {"run", result.run},
      {"method", result.method},
      {"began (UTC)", result.began_utc},
      {"ended (UTC)", result.ended_utc},
      {"software", result.software},
      {"SHA-256 of the result file", result.sha256}};
  lxw_row_t row = 0;
  for (const auto& [name, text] : lines) {
    worksheet_write_string(sheet, row, 0, name, nullptr);
    worksheet_write_string(sheet, row, 1, text.c_str(), nullptr);
    ++row;
  }
}

} // namespace

Expected<void> write_workbook(const std::filesystem::path& path, const StoredResult& result) {
  lxw_workbook* const workbook = workbook_new(path.c_str());
  write_means(workbook, means_table(result));
  write_run(workbook, result);
  if (const lxw_error status = workbook_close(workbook); status != LXW_NO_ERROR) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: cannot be written: {}", path.string(), lxw_strerror(status)));
  }
  return {};
}

} // namespace dyncal::inline views
