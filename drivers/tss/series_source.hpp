// Where the series of a time series sensor come from: its TCP port, or a folder into which it (or
// its own software) writes one file a shot.
//
// A device sends when it has been triggered, not when it is asked. So before a trigger whatever is
// left of earlier ones is dropped (discard_pending), and after it the next series is waited for.
//
// Fails: timeout, malformed, disconnected, refused, not_found. After malformed or disconnected a
// socket is closed, and the next call reconnects.
//
// One thread; StopSignal ends waits from another.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "drivers/error.hpp"
#include "drivers/link/stop_signal.hpp"
#include "drivers/tss/series.hpp"

namespace dyncal::drivers::tss {

class SeriesSource {
public:
  virtual ~SeriesSource() = default;
  // Connects when necessary and drops every series that is already there.
  [[nodiscard]] virtual Expected<void> discard_pending() = 0;
  [[nodiscard]] virtual Expected<Series> next(std::chrono::milliseconds limit) = 0;
};

// `stop` outlives the source.
[[nodiscard]] std::unique_ptr<SeriesSource> series_from_socket(std::string address,
                                                               const StopSignal& stop);
// Files "*.csv" that appear in the folder, in the order of their names; a device writes under
// another name and renames. Files that are there at the first call are old.
[[nodiscard]] std::unique_ptr<SeriesSource> series_from_folder(std::filesystem::path folder,
                                                               const StopSignal& stop);

} // namespace dyncal::drivers::tss
