#include "services/programs/command/pulse_file.hpp"

#include <fstream>
#include <optional>
#include <string_view>

#include <fmt/core.h>

#include "services/base/parsed_number.hpp"

namespace dyncal::inline programs {
namespace {

using analysis::PulseEdge;
using analysis::PulseInput;

constexpr std::size_t max_shown = 60; // of a line in an error message

std::optional<PulseEdge> edge_of(std::string_view line, bool with_input) {
  PulseEdge edge;
  if (with_input) {
    if (line.starts_with("REFT;")) {
      edge.input = PulseInput::reference;
    } else if (!line.starts_with("GPST;")) {
      return std::nullopt;
    }
    line.remove_prefix(5);
  }
  const std::size_t separator = line.find(';');
  if (separator == std::string_view::npos) {
    return std::nullopt;
  }
  const auto number = parsed_number<std::uint64_t>(line.substr(0, separator));
  const auto ticks = parsed_number<std::uint64_t>(line.substr(separator + 1));
  if (!number || !ticks) {
    return std::nullopt;
  }
  edge.number = *number;
  edge.ticks = *ticks;
  return edge;
}

Expected<void> read_file(const std::filesystem::path& path, PulseRecord& record,
                         std::optional<bool>& with_input) {
  std::ifstream stream(path);
  if (!stream) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot be opened", path.string()));
  }
  record.files.push_back(path);
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    if (line.ends_with('\r')) {
      line.pop_back();
    }
    if (line.empty() || line.front() == '#') {
      continue;
    }
    if (!with_input) {
      with_input = line.starts_with("GPST;") || line.starts_with("REFT;");
    }
    const auto edge = edge_of(line, *with_input);
    if (!edge) {
      return fail(ErrorCode::bad_file,
                  fmt::format("{}: line {}: '{}' is not an edge: expected {}", path.string(),
                              number, line.substr(0, max_shown),
                              *with_input ? "GPST;n;ticks or REFT;n;ticks" : "n;ticks"));
    }
    record.edges.push_back(*edge);
    record.places.push_back({record.files.size() - 1, number});
  }
  if (stream.bad()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot be read to its end", path.string()));
  }
  return {};
}

} // namespace

std::string PulseRecord::place(std::size_t edge) const {
  return fmt::format("{}: line {}", files[places[edge].file].filename().string(),
                     places[edge].line);
}

Expected<PulseRecord> read_pulse_files(std::span<const std::filesystem::path> files) {
  PulseRecord record;
  std::optional<bool> with_input;
  for (const std::filesystem::path& file : files) {
    DYNCAL_TRY(read_file(file, record, with_input));
  }
  if (record.edges.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: holds no edges", files.empty() ? "no file" : files[0].string()));
  }
  return record;
}

} // namespace dyncal::inline programs
