// `dyncal verify FILE`: what may be believed of a digital calibration certificate.
//
// Prints one line for each question (services/views/certificate/verification.hpp): schema,
// signature, signer, with --run whether the numbers are those of the stored run and whether that is
// what was measured (services/records/provenance), and what the register of the store says of the
// file: all that can be asked of a PDF. Exit status 0 only if all hold; else that of the first that
// does not: 3 not readable, 4 schema, 5 not signed, 6 signature, 7 signer, 8 numbers, 9 measured,
// 10 issued; 1 when a file that is named cannot be read. Belongs to one thread.
#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/base/printable_text.hpp"
#include "services/base/whole_file.hpp"
#include "services/contract/digest.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/provenance/result_provenance.hpp"
#include "services/records/store/document_register.hpp"
#include "services/records/store/store.hpp"
#include "services/views/certificate/verification.hpp"
#include "services/views/language/translated_texts.hpp"
#include "services/views/report/amendments.hpp"

namespace dyncal::inline programs {
namespace {

struct VerifyOptions {
  VerificationRequest request;
  StorePlace store;
};

void add_verify(CLI::App& command, VerifyOptions& options) {
  VerificationRequest& verify = options.request;
  command.add_option("FILE", verify.certificate, "certificate (DCC, XML), or report (PDF)")
      ->required();
  take_run(command.add_option("--run", verify.run,
                              "run folder or result file that its numbers should be those of"));
  command.add_option("--trust", verify.trusted,
                     "X.509 certificates, PEM, of the laboratory or its CA, one or more");
  command.add_option("--schema", verify.schema,
                     "dcc.xsd to hold it against (default: the installed one)");
  add_store_place(command, options.store);
}

constexpr std::uintmax_t max_document_bytes = 256U << 20U;

bool is_pdf(const std::string& bytes) {
  return bytes.starts_with("%PDF");
}

std::string what_was_issued(const IssuedDocument& document) {
  return fmt::format("number {}, {} of run '{}' of bench '{}', issued {}", document.number,
                     document.kind, document.run, document.bench, document.issued_utc);
}

// What was amended of its run after it was issued; empty: nothing.
Expected<std::string> corrected_since(const IssuedDocument& document, const std::string& place) {
  constexpr std::size_t seconds_length = 19; // "2026-03-01T12:00:00"
  DYNCAL_TRY(const auto store, Store::open_existing(place));
  DYNCAL_TRY(auto entries, store->entries_of(document.bench, document.run));
  std::erase_if(entries, [&](const JournalEntry& entry) {
    return entry.utc.substr(0, seconds_length) <= document.issued_utc.substr(0, seconds_length);
  });
  const auto sentences = amendment_sentences(entries);
  return sentences.empty() ? ""
                           : fmt::format("; corrected since, so that a revision is due: {}",
                                         fmt::join(sentences, "; "));
}

// Of a file that the register does not know nothing is said, if it can be asked otherwise.
Expected<std::optional<VerificationFinding>> said_by_register(const std::string& bytes,
                                                              const std::string& place) {
  std::error_code unknown;
  std::optional<IssuedDocument> document;
  std::string replacement;
  if (!place.empty() && (is_server(place) || std::filesystem::exists(place, unknown))) {
    DYNCAL_TRY(const auto known, DocumentRegister::open(place));
    DYNCAL_TRY(document, known->find_file(sha256_hex(bytes)));
    if (document) {
      DYNCAL_TRY(replacement, known->replacement_of(document->number));
    }
  }
  if (!replacement.empty()) {
    return VerificationFinding{
        Verification::issued, false,
        fmt::format("{}; {} has taken its place", what_was_issued(*document), replacement)};
  }
  if (document) {
    DYNCAL_TRY(const auto corrections, corrected_since(*document, place));
    return VerificationFinding{Verification::issued, corrections.empty(),
                               what_was_issued(*document) + corrections};
  }
  if (!is_pdf(bytes)) {
    return std::nullopt;
  }
  return VerificationFinding{
      Verification::issued, false,
      fmt::format("the register of {} does not know this file: it was never issued as it is",
                  place.empty() ? "no store" : without_password(place))};
}

VerificationFinding said_by_records(const VerifyOptions& options, const std::stop_token& stop) {
  const auto held =
      with_progress("holding the result against its recording", [&](const auto& count) {
        return read_held_result(options.request.run, options.store.text_for(options.request.run),
                                count, stop);
      });
  if (!held) {
    return {Verification::measured, false, held.error().message};
  }
  const bool holds = held->objections.empty();
  const std::vector<std::string> sentences =
      texts_in(Language::english, holds ? held->statements : held->objections);
  return {Verification::measured, holds, fmt::format("{}", fmt::join(sentences, " "))};
}

Expected<std::vector<VerificationFinding>> findings_of(const VerifyOptions& options,
                                                       const std::stop_token& stop) {
  const VerificationRequest& request = options.request;
  DYNCAL_TRY(const auto bytes, read_whole_file(request.certificate, max_document_bytes));
  std::vector<VerificationFinding> findings;
  if (!is_pdf(bytes)) {
    DYNCAL_TRY(findings, with_progress("verifying", [&](const auto&) { return verify(request); }));
  }
  if (!request.run.empty()) {
    findings.push_back(said_by_records(options, stop));
  }
  DYNCAL_TRY(auto issued, said_by_register(bytes, options.store.text_for(request.run)));
  if (issued) {
    findings.push_back(std::move(*issued));
  }
  return findings;
}

Expected<int> run_verify(const VerifyOptions& options, const std::stop_token& stop) {
  const VerificationRequest& request = options.request;
  DYNCAL_TRY(const auto findings, findings_of(options, stop));
  for (const VerificationFinding& finding : findings) {
    fmt::print("{:<10} {}: {}\n", to_string(finding.question), finding.holds ? "ok" : "FAILED",
               one_line(finding.sentence));
  }
  const auto first = std::ranges::find(findings, false, &VerificationFinding::holds);
  if (first == findings.end()) {
    fmt::print("{} is verified\n", request.certificate.string());
    return 0;
  }
  fmt::print(stderr, "{} is NOT verified\n", request.certificate.string());
  return static_cast<int>(first->question);
}

const Command verify_command{
    230, "verify",
    "check a digital calibration certificate: schema, signature, signer, numbers; a PDF: issued",
    add_verify, run_verify};

} // namespace
} // namespace dyncal::inline programs
