#include "services/records/store/document_register.hpp"

#include <algorithm>
#include <ctime>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "services/records/store/audit_trail.hpp"
#include "services/records/store/migrations.hpp"

namespace dyncal::inline records {
namespace {

IssuedDocument document_of(const DatabaseRow& row) {
  return {.sha256 = text_of(row[0]),
          .number = text_of(row[1]),
          .kind = text_of(row[2]),
          .identifier = text_of(row[3]),
          .replaces = text_of(row[4]),
          .issued_utc = text_of(row[5]),
          .result_sha256 = text_of(row[6]),
          .bench = text_of(row[7]),
          .run = text_of(row[8]),
          .serial = text_of(row[9]),
          .file = text_of(row[10])};
}

tl::unexpected<Error> taken(const IssuedDocument& wanted, const IssuedDocument& known) {
  return fail(ErrorCode::bad_argument,
              fmt::format("number {} was given to the {} of run '{}' of bench '{}' on {} ({}); "
                          "a number is given once: take another, and --replaces {} if this "
                          "document is to take the place of that one",
                          wanted.number, known.kind, known.run, known.bench,
                          known.issued_utc.substr(0, 10), known.file, wanted.number));
}

} // namespace

Expected<std::unique_ptr<DocumentRegister>> DocumentRegister::open(const std::string& place) {
  DYNCAL_TRY(auto database, open_migrated(place));
  return std::unique_ptr<DocumentRegister>(new DocumentRegister(std::move(database)));
}

Expected<std::vector<IssuedDocument>> DocumentRegister::where(const std::string& column,
                                                              const std::string& value) {
  DYNCAL_TRY(const auto rows,
             database_->execute(
                 fmt::format("SELECT document_sha256, number, kind, identifier, replaces, "
                             "issued_utc, result_sha256, bench, run, serial, file FROM documents "
                             "WHERE {} = $1",
                             column),
                 {value}));
  std::vector<IssuedDocument> documents;
  std::ranges::transform(rows, std::back_inserter(documents), document_of);
  return documents;
}

Expected<void> DocumentRegister::check_replaced(const IssuedDocument& document) {
  DYNCAL_TRY(const auto replaced, of_number(document.replaces));
  if (replaced.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("no document has number {}, so none can be replaced by {}",
                            document.replaces, document.number));
  }
  DYNCAL_TRY(const auto others, where("replaces", document.replaces));
  const auto other = std::ranges::find_if(
      others, [&](const IssuedDocument& one) { return one.number != document.number; });
  if (other != others.end()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("number {} was replaced by {} already; replace that one",
                            document.replaces, other->number));
  }
  return {};
}

Expected<void> DocumentRegister::check(const IssuedDocument& document) {
  DYNCAL_TRY(const auto known, of_number(document.number));
  for (const IssuedDocument& one : known) {
    const bool is_of_other = one.result_sha256 != document.result_sha256 ||
                             one.serial != document.serial || one.replaces != document.replaces;
    if (is_of_other || one.kind == document.kind) {
      return taken(document, one);
    }
  }
  return document.replaces.empty() ? Expected<void>{} : check_replaced(document);
}

Expected<void> DocumentRegister::enter(const IssuedDocument& document, const ActingPerson& by) {
  const std::string now = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  return database_->transaction([&]() -> Expected<void> {
    DYNCAL_TRY(check(document));
    DYNCAL_TRY(database_->execute(
        "INSERT INTO documents (document_sha256, number, kind, identifier, replaces, issued_utc, "
        "result_sha256, bench, run, serial, file) "
        "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
        {document.sha256, document.number, document.kind, document.identifier, document.replaces,
         now, document.result_sha256, document.bench, document.run, document.serial,
         document.file}));
    return add_to_audit(*database_,
                        {AuditAction::document_issued, document.sha256,
                         fmt::format("{} {} of run {} of bench {}, {}", document.kind,
                                     document.number, document.run, document.bench, document.file)},
                        by);
  });
}

Expected<std::optional<IssuedDocument>> DocumentRegister::find_file(const std::string& sha256) {
  DYNCAL_TRY(auto found, where("document_sha256", sha256));
  return found.empty() ? std::nullopt : std::optional(std::move(found.front()));
}

Expected<std::vector<IssuedDocument>> DocumentRegister::of_run(const std::string& bench,
                                                               const std::string& run) {
  DYNCAL_TRY(auto documents, where("run", run));
  std::erase_if(documents, [&](const IssuedDocument& one) { return one.bench != bench; });
  std::ranges::stable_sort(documents, {}, &IssuedDocument::issued_utc);
  return documents;
}

Expected<std::string> DocumentRegister::replacement_of(const std::string& number) {
  DYNCAL_TRY(const auto others, where("replaces", number));
  return others.empty() ? std::string() : others.front().number;
}

} // namespace dyncal::inline records
