// Plays a file through FileSource and says how that ended, for tests.
#pragma once

#include <string>

#include "drivers/files/file_source.hpp"
#include "tests/unit/drivers/collecting_sink.hpp"
#include "tests/unit/drivers/files/temporary_file.hpp"

namespace dyncal::drivers::files {

using tests::CollectingSink;

inline FileSettings settings_for(const TemporaryFile& file) {
  FileSettings settings;
  settings.path = file.path();
  return settings;
}

// The message of the error that describing or playing ends with; empty when there was none.
inline std::string problem_of(const FileSettings& settings) {
  FileSource source(settings);
  CollectingSink sink;
  const auto described = source.describe();
  if (!described) {
    return described.error().message;
  }
  const auto played = source.run(sink);
  return played ? "" : played.error().message;
}

} // namespace dyncal::drivers::files
