#include "services/views/report/run_journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/link/file_descriptor.hpp"
#include "drivers/utc_clock.hpp"
#include "services/base/json_text.hpp"
#include "services/base/per_enumerator.hpp"
#include "services/base/whole_file.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/views/language/journal_sentences.hpp"

namespace dyncal::inline views {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t max_journal_bytes = 1U << 26U;

std::string text_at(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

ActingPerson person_at(const Json& json) {
  const Json by = json.value("by", Json::object());
  return {text_at(by, "name"), text_at(by, "user"), text_at(by, "host")};
}

std::vector<AmendedValue> changes_at(const Json& json) {
  std::vector<AmendedValue> changes;
  for (const Json& one : json.value("changes", Json::array())) {
    changes.push_back({text_at(one, "key"), text_at(one, "before"), text_at(one, "after")});
  }
  return changes;
}

std::optional<JournalKind> kind_of(const std::string& name) {
  for (const JournalKind kind : {JournalKind::note, JournalKind::event, JournalKind::amendment}) {
    if (kind_name(kind) == name) {
      return kind;
    }
  }
  return std::nullopt;
}

// "dau/serial" is "serial number of dau".
std::string subject_of(const std::string& key, Language language) {
  const std::size_t slash = key.find('/');
  const std::string own = slash == std::string::npos ? key : key.substr(slash + 1);
  const auto* const known =
      std::ranges::find(sentences::amendable_names, own, &sentences::AmendableName::key);
  const std::string name = known == sentences::amendable_names.end() ? own : known->name(language);
  return slash == std::string::npos
             ? name
             : sentences::key_of_source(language, name, key.substr(0, slash));
}

tl::unexpected<Error> cannot_write(const std::filesystem::path& file) {
  return fail(ErrorCode::bad_file, fmt::format("{}: the journal of the run cannot be written: {}",
                                               file.string(), std::strerror(errno)));
}

} // namespace

std::string kind_name(JournalKind kind) {
  return per_enumerator(kind, {"note", "event", "amendment"});
}

JournalEntry journal_entry(JournalKind kind, std::string text, ActingPerson by) {
  return {kind, utc_text(utc_now_ns()), std::move(by), std::move(text)};
}

std::string line_of(const JournalEntry& entry) {
  Json json{{"kind", kind_name(entry.kind)},
            {"utc", entry.utc},
            {"by", {{"name", entry.by.name}, {"user", entry.by.user}, {"host", entry.by.host}}},
            {"text", entry.text}};
  for (const AmendedValue& change : entry.changes) {
    json["changes"].push_back(
        {{"key", change.key}, {"before", change.before}, {"after", change.after}});
  }
  return json_text(json);
}

Expected<JournalEntry> journal_entry_of(const std::string& line, const std::string& place) {
  const Json json = Json::parse(line, nullptr, false);
  const bool is_object = json.is_object();
  const auto kind = is_object ? kind_of(text_at(json, "kind")) : std::nullopt;
  if (!kind || parse_utc_text(text_at(json, "utc")) == 0 ||
      (json.contains("changes") && !json["changes"].is_array()) ||
      (json.contains("by") && !json["by"].is_object())) {
    return fail(
        ErrorCode::bad_file,
        fmt::format("{}: is not an entry of a journal; take the file from a back-up", place));
  }
  return JournalEntry{*kind, text_at(json, "utc"), person_at(json), text_at(json, "text"),
                      changes_at(json)};
}

Expected<std::vector<JournalEntry>> read_journal(const std::filesystem::path& run_folder) {
  const std::filesystem::path file = run_folder / journal_file_name;
  std::error_code unknown;
  if (!std::filesystem::exists(file, unknown)) {
    return std::vector<JournalEntry>{};
  }
  DYNCAL_TRY(const auto text, read_whole_file(file, max_journal_bytes));
  std::istringstream lines(text);
  std::vector<JournalEntry> entries;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    DYNCAL_TRY(auto entry, journal_entry_of(line, fmt::format("{}:{}", file.string(), ++number)));
    entries.push_back(std::move(entry));
  }
  return entries;
}

Expected<void> append_to_journal(const std::filesystem::path& run_folder,
                                 const JournalEntry& entry) {
  const std::filesystem::path file = run_folder / journal_file_name;
  const drivers::FileDescriptor descriptor(
      open(file.c_str(), O_CREAT | O_WRONLY | O_APPEND | O_CLOEXEC, 0666));
  const std::string line = line_of(entry) + '\n';
  if (descriptor.number() < 0 ||
      write(descriptor.number(), line.data(), line.size()) != static_cast<ssize_t>(line.size()) ||
      fsync(descriptor.number()) != 0) {
    return cannot_write(file);
  }
  return {};
}

void sort_journal(std::vector<JournalEntry>& entries) {
  std::ranges::stable_sort(entries, {}, &JournalEntry::utc);
}

std::vector<std::string> amendment_sentences(const JournalEntry& entry, Language language) {
  constexpr std::size_t date_length = 10;
  std::vector<std::string> all;
  for (const AmendedValue& change : entry.changes) {
    all.push_back(sentences::amended(
        language, subject_of(change.key, language), change.after,
        day_text(language, entry.utc.substr(0, date_length)), name_of(entry.by),
        change.before.empty() ? "" : sentences::was_before(language, change.before), entry.text));
  }
  return all;
}

} // namespace dyncal::inline views
