// `dyncal note RUN TEXT`: a note to a run, while it goes on or later, with time and who writes it;
// `--list` what was noted of it, and what happened in it. It goes into the journal of the run
// folder first, which is what is left if the rest fails, then into the store. Belongs to one
// thread.
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/journal_keeping.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/views/report/run_journal.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

struct NoteOptions {
  std::string run; // its folder
  std::string text;
  std::string name; // of the operator
  bool list = false;
  bool json = false;
  StorePlace store;
};

void add_note(CLI::App& command, NoteOptions& note) {
  take_run(command.add_option("RUN", note.run, "run folder, also of a run that goes on"))
      ->required();
  auto* text = command.add_option("TEXT", note.text, "the note, in quotation marks");
  add_operator_option(command, note.name);
  auto* list =
      command.add_flag("--list", note.list, "list notes, amendments and events of the run")
          ->excludes(text);
  command.add_flag("--json", note.json, "list as JSON")->needs(list);
  add_store_place(command, note.store);
}

std::string text_of_entry(const JournalEntry& entry) {
  std::string text;
  for (const std::string& sentence : amendment_sentences(entry)) {
    text += (text.empty() ? "" : "; ") + sentence;
  }
  return text.empty() ? entry.text : text;
}

Expected<void> list_journal(const NoteOptions& command) {
  DYNCAL_TRY(auto entries, read_journal(command.run));
  sort_journal(entries);
  if (command.json) {
    Json json{{"entries", Json::array()}};
    for (const JournalEntry& entry : entries) {
      json["entries"].push_back(Json::parse(line_of(entry)));
    }
    fmt::print("{}\n", json_text(json, 2));
    return {};
  }
  if (entries.empty()) {
    return fail(ErrorCode::no_result, fmt::format("{}: nothing was noted", command.run));
  }
  constexpr std::size_t seconds_length = 19;
  for (const JournalEntry& entry : entries) {
    fmt::print("{}Z  {:<9}  {}: {}\n", entry.utc.substr(0, seconds_length), kind_name(entry.kind),
               one_line(name_of(entry.by)), one_line(text_of_entry(entry)));
  }
  return {};
}

Expected<void> run_note(const NoteOptions& command) {
  DYNCAL_TRY(check_run_folder(command.run));
  if (command.list) {
    return list_journal(command);
  }
  if (command.text.empty()) {
    return fail(ErrorCode::bad_argument, "what is to be noted? Give TEXT in quotation marks, or "
                                         "--list what was");
  }
  const ActingPerson by = acting_person(command.name);
  DYNCAL_TRY(keep_entry(command.run, command.store,
                        journal_entry(JournalKind::note, one_line(command.text), by)));
  fmt::print("noted by {}\n", text_of(by));
  return {};
}

const Command note_command{92, "note", "note something about a run, or list what was noted",
                           add_note, run_note};

} // namespace
} // namespace dyncal::inline programs
