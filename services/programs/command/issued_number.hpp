// The number that a document is issued under, and the register of the store that it is entered in.
// One thread.
#pragma once

#include <optional>
#include <string>

#include "services/programs/command/keep_options.hpp"
#include "services/records/store/document_register.hpp"
#include "services/views/objections/held_result.hpp"

namespace dyncal::inline programs {

struct NumberOptions {
  StorePlace store;     // whose register it is
  std::string number;   // empty: that of the sensor file
  std::string replaces; // empty: nothing
};

// --number, --replaces, and those of the store
void add_number_options(CLI::App& command, NumberOptions& options);

// The document of this kind whose place the new one takes; nothing: there is none of this kind, or
// nothing is replaced. Fails (bad_argument) where `replaces` is no number of the register.
[[nodiscard]] Expected<std::optional<IssuedDocument>>
replaced_document(const NumberOptions& options, const std::string& place, const std::string& kind);

// Of the file with this text.
[[nodiscard]] IssuedDocument document_of(const StoredResult& result, const std::string& text,
                                         const std::filesystem::path& file);

// Before a document that counts. Fails (no_result) where nothing shows that the result is what was
// measured.
[[nodiscard]] Expected<void> require_proof(const HeldResult& held);

// Into the register at `place`, before its file is written. Fails (bad_argument) without a place.
[[nodiscard]] Expected<void> enter_document(const std::string& place,
                                            const IssuedDocument& document);

} // namespace dyncal::inline programs
