#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fmt/core.h>

#include "services/checks/bench_check/checks.hpp"
#include "services/contract/digest.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

constexpr std::size_t piece_bytes = 1U << 20U;

// Nothing when the file cannot be read to its end.
std::optional<std::string> digest_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  Digest digest;
  std::vector<char> piece(piece_bytes);
  while (file) {
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    digest.add(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  return file.eof() ? std::optional(digest.hex()) : std::nullopt;
}

// Where the bench file names a file.
KeyPath key_of(const BenchView& view, const NamedFile& named) {
  std::vector<KeyPath> keys{{"corrections", "adc", "file"},
                            {"corrections", "reference"},
                            {"corrections", "dso_delay", "file"}};
  for (const SourceSettings& source : view.bench.sources) {
    for (const char* key : {"path", "dbc", "log"}) {
      keys.push_back({"sources", source.name, key});
    }
    keys.push_back({"sources", source.name, "interferometer", "ellipse"});
  }
  const auto found = std::ranges::find_if(
      keys, [&](const KeyPath& key) { return view.lines.text_at(key) == named.name; });
  return found == keys.end() ? KeyPath{} : *found;
}

bool has_problem(const BenchView& view, const KeyPath& key) {
  return std::ranges::any_of(view.sources, [&](const SourceView& source) {
    return source.problem && key == KeyPath{"sources", source.name, source.problem_key};
  });
}

// A range of a channel that is not there would say nothing.
void check_ranges(const BenchView& view, const SourceSettings& source, Findings& findings) {
  const SourceView* const seen = view.source(source.name);
  if (seen == nullptr || !seen->description) {
    return;
  }
  for (const auto& [channel, range] : source.identity.ranges) {
    if (std::ranges::find(seen->description->channels, channel,
                          &drivers::ChannelDescription::name) ==
        seen->description->channels.end()) {
      findings.push_back(
          view.at(Severity::error, {"sources", source.name, "ranges"},
                  fmt::format("gives a range to '{}', which is no channel of it", channel)));
    }
  }
}

} // namespace

Findings check_files(const BenchView& view) {
  Findings findings;
  for (const NamedFile& named : view.bench.named_files) {
    const KeyPath key = key_of(view, named);
    std::error_code unknown;
    const auto status = std::filesystem::status(named.path, unknown);
    if (std::filesystem::is_directory(status)) {
      continue; // the folder of shots, which is looked into
    }
    if (status.type() == std::filesystem::file_type::not_found) {
      findings.push_back(
          view.at(Severity::error, key,
                  fmt::format("names {}, which does not exist", named.path.string())));
      continue;
    }
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
      continue; // a pipe would be waited for
    }
    const auto digest = digest_of(named.path);
    if (!digest && has_problem(view, key)) {
      continue; // which is reported below
    }
    findings.push_back(
        digest
            ? view.at(Severity::note, key, fmt::format("names {}, SHA-256 {}", named.name, *digest))
            : view.at(Severity::error, key,
                      fmt::format("names {}, which cannot be read; may you read it?",
                                  named.path.string())));
  }
  if (view.adc_problem) {
    findings.push_back(
        view.at(Severity::error, {"corrections", "adc", "file"}, "names " + *view.adc_problem));
  }
  for (const SourceSettings& source : view.bench.sources) {
    check_ranges(view, source, findings);
  }
  for (const SourceView& source : view.sources) {
    if (source.problem) {
      findings.push_back(view.at(Severity::error, {"sources", source.name, source.problem_key},
                                 "names what cannot be used: " + *source.problem));
    }
    for (const std::string& warning : source.warnings) {
      findings.push_back(view.at(Severity::warning, {"sources", source.name, source.problem_key},
                                 "names a file that is only partly understood: " + warning));
    }
  }
  return findings;
}

} // namespace dyncal::inline checks::bench_check
