#include "services/programs/command/issued_number.hpp"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "services/contract/digest.hpp"

namespace dyncal::inline programs {
namespace {

tl::unexpected<Error> no_register(const std::string& number) {
  return fail(ErrorCode::bad_argument,
              "number " + number +
                  " cannot be entered: numbers are kept in the store, and --store none names none");
}

} // namespace

void add_number_options(CLI::App& command, NumberOptions& options) {
  command.add_option("--number", options.number,
                     "number of the document, given once (default: that of the sensor file)");
  command.add_option("--replaces", options.replaces,
                     "number of the document whose place this one takes");
  add_store_place(command, options.store);
}

Expected<std::optional<IssuedDocument>>
replaced_document(const NumberOptions& options, const std::string& place, const std::string& kind) {
  if (options.replaces.empty()) {
    return std::nullopt;
  }
  if (place.empty()) {
    return no_register(options.replaces);
  }
  DYNCAL_TRY(const auto known, DocumentRegister::open(place));
  DYNCAL_TRY(const auto documents, known->of_number(options.replaces));
  if (documents.empty()) {
    return fail(
        ErrorCode::bad_argument,
        fmt::format("no document has number {}, so none can be replaced", options.replaces));
  }
  const auto found = std::ranges::find(documents, kind, &IssuedDocument::kind);
  return found == documents.end() ? std::nullopt : std::optional(*found);
}

IssuedDocument document_of(const StoredResult& result, const std::string& text,
                           const std::filesystem::path& file) {
  return {.sha256 = sha256_hex(text),
          .number = {},
          .kind = {},
          .replaces = {},
          .result_sha256 = result.sha256,
          .bench = result.bench,
          .run = result.run,
          .serial = {},
          .file = std::filesystem::absolute(file).lexically_normal().string()};
}

Expected<void> require_proof(const HeldResult& held) {
  if (held.objections.empty()) {
    return {};
  }
  return fail(ErrorCode::no_result,
              fmt::format("{}: nothing is signed or issued of it, forced or not: {}",
                          held.result.file.string(), held.objections.front().english));
}

Expected<void> enter_document(const std::string& place, const IssuedDocument& document) {
  if (place.empty()) {
    return no_register(document.number);
  }
  DYNCAL_TRY(const auto known, DocumentRegister::open(place));
  return known->enter(document);
}

} // namespace dyncal::inline programs
