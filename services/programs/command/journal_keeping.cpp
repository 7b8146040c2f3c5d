#include "services/programs/command/journal_keeping.hpp"

#include <fmt/core.h>

#include "services/bench/file/named_files.hpp"
#include "services/records/store/store.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline programs {

Expected<void> check_run_folder(const std::filesystem::path& run) {
  std::error_code unknown;
  if (std::filesystem::is_directory(run, unknown) &&
      std::filesystem::exists(run / result_file_name, unknown)) {
    return {};
  }
  return fail(ErrorCode::bad_argument,
              fmt::format("{}: is no folder of a run; give runs/BENCH/NAME", run.string()));
}

Expected<void> keep_entry(const std::filesystem::path& run, const StorePlace& store,
                          const JournalEntry& entry) {
  DYNCAL_TRY(const auto result, read_result(run));
  DYNCAL_TRY(append_to_journal(run, entry));
  const std::string place = store.text_for(run);
  if (place.empty()) {
    return {};
  }
  auto kept = Store::open(place).and_then([&](std::unique_ptr<Store> opened) {
    return opened->add_entries(result.bench, result.run, {entry}, entry.by);
  });
  if (!kept) {
    kept.error().message =
        fmt::format("{} of {} is in {}, and not in the store: {}; add it with "
                    "'dyncal store add {}'",
                    kind_name(entry.kind), entry.utc, (run / journal_file_name).string(),
                    kept.error().message, run.string());
  }
  return kept;
}

} // namespace dyncal::inline programs
