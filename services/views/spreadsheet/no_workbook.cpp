// In place of means_workbook.cpp where libxlsxwriter was missing when dyncal was built.
#include "services/views/spreadsheet/means_workbook.hpp"

namespace dyncal::inline views {

Expected<void> write_workbook(const std::filesystem::path& /*path*/,
                              const StoredResult& /*result*/) {
  return fail(ErrorCode::bad_argument,
              "this build of dyncal writes no XLSX: libxlsxwriter was missing when it was built "
              "(Debian: apt install libxlsxwriter-dev, then build again); CSV it writes");
}

} // namespace dyncal::inline views
