#include "services/records/exchange/row_formats.hpp"

namespace dyncal::inline records {

RowProgress::RowProgress(const RowExport& wanted) : progress_(wanted.progress) {
  for (const RowTable& table : wanted.tables) {
    all_ += table.rows();
  }
}

Expected<void> RowProgress::for_each(const RowTable& table,
                                     const std::function<Expected<void>(const Rows&)>& visit) {
  return table.for_each([&](const Rows& rows) -> Expected<void> {
    done_ += rows.count;
    if (!progress_(0.2 + 0.8 * static_cast<double>(done_) / static_cast<double>(all_))) {
      return fail(ErrorCode::interrupted, "stopped before everything was written: nothing is left");
    }
    return visit(rows);
  });
}

} // namespace dyncal::inline records
