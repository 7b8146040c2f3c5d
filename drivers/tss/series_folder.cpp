#include <fstream>
#include <iterator>
#include <utility>

#include "drivers/tss/series_source.hpp"
#include "drivers/utc_clock.hpp"

namespace dyncal::drivers::tss {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds poll_interval{20};

class FolderSource : public SeriesSource {
public:
  FolderSource(std::filesystem::path folder, const StopSignal& stop)
      : folder_(std::move(folder)), stop_(stop) {}

  Expected<void> discard_pending() override {
    DYNCAL_TRY(known_names_, csv_names());
    folder_was_read_ = true;
    return {};
  }

  Expected<Series> next(milliseconds limit) override {
    if (!folder_was_read_) {
      DYNCAL_TRY(discard_pending());
    }
    const auto deadline = Clock::now() + limit;
    for (;;) {
      DYNCAL_TRY(const auto names, csv_names());
      for (const std::string& name : names) { // in the order of their names
        if (known_names_.insert(name).second) {
          return read(folder_ / name);
        }
      }
      if (Clock::now() >= deadline) {
        return sensor_error(ErrorCode::timeout, folder_.string() + ": no new series within " +
                                                    std::to_string(limit.count()) + " ms");
      }
      if (stop_.wait_for(poll_interval)) {
        return sensor_error(ErrorCode::disconnected, folder_.string() + ": stopped");
      }
    }
  }

private:
  Expected<std::set<std::string>> csv_names() const {
    std::error_code problem;
    std::set<std::string> names;
    for (std::filesystem::directory_iterator entry(folder_, problem), end; !problem && entry != end;
         entry.increment(problem)) {
      if (entry->path().extension() == ".csv") {
        names.insert(entry->path().filename().string());
      }
    }
    if (problem) {
      return sensor_error(ErrorCode::not_found,
                          folder_.string() + ": cannot be read (" + problem.message() + ")");
    }
    return names;
  }

  static Expected<Series> read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)),
                           std::istreambuf_iterator<char>());
    if (!file) {
      return sensor_error(ErrorCode::not_found, path.string() + ": cannot be read");
    }
    auto series = parse_series_csv(text);
    if (!series) {
      return sensor_error(series.error().code, path.string() + ": " + series.error().message);
    }
    series->received_utc_ns = utc_now_ns();
    return series;
  }

  static tl::unexpected<Error> sensor_error(ErrorCode code, std::string message) {
    return fail(code, "time series sensor " + std::move(message));
  }

  std::filesystem::path folder_;
  const StopSignal& stop_;
  std::set<std::string> known_names_;
  bool folder_was_read_ = false;
};

} // namespace

std::unique_ptr<SeriesSource> series_from_folder(std::filesystem::path folder,
                                                 const StopSignal& stop) {
  return std::make_unique<FolderSource>(std::move(folder), stop);
}

} // namespace dyncal::drivers::tss
