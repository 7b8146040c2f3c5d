// When a run has ended its results are on the disk, also if the power fails at that instant:
// contents first, then the name, then the folder; and before the database, which may let wait.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/system/live_bench.hpp"

namespace dyncal::tests {
namespace {

using Lines = std::vector<std::string>;

Lines lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  Lines lines;
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

// Its place behind all before it; the number of lines if it is not there.
std::size_t place_of(const Lines& lines, const std::string& line, std::size_t from = 0) {
  return static_cast<std::size_t>(
      std::find(lines.begin() + static_cast<std::ptrdiff_t>(from), lines.end(), line) -
      lines.begin());
}

// Where the file was on the disk for the last time.
std::size_t place_on_disk(const Lines& lines, const std::filesystem::path& file) {
  const auto last = std::find(lines.rbegin(), lines.rend(), "name " + file.string());
  EXPECT_NE(last, lines.rend()) << file;
  if (last == lines.rend()) {
    return lines.size();
  }
  const auto named = static_cast<std::size_t>(lines.rend() - last) - 1;
  EXPECT_LT(place_of(lines, "sync " + file.string() + ".part"), named) << file;
  const std::size_t in_folder = place_of(lines, "sync " + file.parent_path().string(), named);
  EXPECT_LT(in_folder, lines.size()) << file;
  return in_folder;
}

TEST(DiskOrder, HasResultsOnTheDiskBeforeTheDatabase) {
  const auto folder = std::filesystem::canonical(fresh_folder("disk-order"));
  LiveBenchSettings settings;
  settings.bench_arguments = {"--speed", "8"};
  settings.excitation = "frequencies_hz = [\"40\", \"80\"]\nlevel = 10.0\nsettling_s = 0.5\n"
                        "duration_s = 1.0\n";
  LiveBench bench(folder, settings);
  const auto log = folder / "order.txt";
  setenv("DYNCAL_DISK_ORDER", log.c_str(), 1);
  setenv("LD_PRELOAD", DYNCAL_DISK_ORDER_SHIM, 1);
  ProgramRun& run = bench.start(
      {"run", bench.bench_file(), "--folder", folder / "runs", "--output", folder / "asked.json"});
  unsetenv("LD_PRELOAD");
  unsetenv("DYNCAL_DISK_ORDER");
  ASSERT_EQ(run.wait(patience), 0) << run.errors();

  const Lines lines = lines_of(log);
  const auto kept = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
    return line.starts_with("name ") && line.ends_with("/result.json");
  });
  ASSERT_NE(kept, lines.end());
  const std::size_t kept_place = place_on_disk(lines, kept->substr(5));
  const std::size_t asked_place = place_on_disk(lines, folder / "asked.json");
  const auto stored = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
    return line.starts_with("write ");
  });
  ASSERT_NE(stored, lines.end()) << "the store was not written";
  const auto stored_place = static_cast<std::size_t>(stored - lines.begin());
  EXPECT_LT(kept_place, stored_place);
  EXPECT_LT(asked_place, stored_place);
}

} // namespace
} // namespace dyncal::tests
