// `dyncal amend RUN KEY=VALUE... --reason TEXT`: corrects what was stated of a run, never what was
// measured (views/report/amendments.hpp). Old and new stay in the journal of the run folder and in
// the store; lists and documents use the new value and name the correction. Documents that were
// issued before are named: they need a revision. Belongs to one thread.
#include <utility>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/journal_keeping.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/records/store/document_register.hpp"
#include "services/views/report/amendments.hpp"

namespace dyncal::inline programs {
namespace {

struct AmendOptions {
  std::string run; // its folder
  std::vector<std::string> assignments;
  std::string reason;
  std::string name; // of the operator
  StorePlace store;
};

void add_amend(CLI::App& command, AmendOptions& amend) {
  take_run(command.add_option("RUN", amend.run, "run folder"))->required();
  command
      .add_option("CHANGE", amend.assignments,
                  "KEY=VALUE, repeatable: serial, model, customer, operator, comment, "
                  "mounting, temperature_degc, ...")
      ->required();
  command.add_option("--reason", amend.reason, "why, for documents")->required();
  add_operator_option(command, amend.name);
  add_store_place(command, amend.store);
}

// What was issued of the run and states what is corrected now.
Expected<void> name_documents(const StoredResult& result, const std::string& place) {
  if (place.empty()) {
    return {};
  }
  DYNCAL_TRY(const auto known, DocumentRegister::open(place));
  DYNCAL_TRY(const auto documents, known->of_run(result.bench, result.run));
  for (const IssuedDocument& document : documents) {
    DYNCAL_TRY(const auto replacement, known->replacement_of(document.number));
    if (replacement.empty()) {
      fmt::print("{} {} of {} ({}) was issued before: issue a revision with --replaces {}\n",
                 document.kind, one_line(document.number), document.issued_utc.substr(0, 10),
                 one_line(document.file), one_line(document.number));
    }
  }
  return {};
}

Expected<void> run_amend(const AmendOptions& command) {
  DYNCAL_TRY(check_run_folder(command.run));
  DYNCAL_TRY(auto result, read_result(command.run));
  DYNCAL_TRY(auto journal, read_journal(command.run));
  add_journal(std::move(journal), result);
  const std::string reason = one_line(command.reason);
  if (reason.find_first_not_of(' ') == std::string::npos) {
    return fail(ErrorCode::bad_argument, "--reason is empty: documents state why");
  }
  JournalEntry entry = journal_entry(JournalKind::amendment, reason, acting_person(command.name));
  for (const std::string& assignment : command.assignments) {
    DYNCAL_TRY(auto change, amended_value(result, one_line(assignment)));
    entry.changes.push_back(std::move(change));
  }
  DYNCAL_TRY(keep_entry(command.run, command.store, entry));
  for (const std::string& sentence : amendment_sentences(entry)) {
    fmt::print("{}\n", one_line(sentence));
  }
  return name_documents(result, command.store.text_for(command.run));
}

const Command amend_command{94, "amend",
                            "correct what was stated of a run, with its reason and both values "
                            "kept",
                            add_amend, run_amend};

} // namespace
} // namespace dyncal::inline programs
