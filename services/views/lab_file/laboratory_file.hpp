// LAB.toml: what a laboratory states in its documents. `[laboratory]` is needed; the others are
// there for what uses them: `[letterhead]`, `[[person]]`, `[customer]`, `[reference]`,
// `[[equipment]]`, `[conditions]`.
//
// `language`, "de" or "de,en", is that of the documents where none is asked for; English else.
//
// Paths in the file are relative to it. Keys that are not known are refused, so that a misspelt one
// does not vanish from a certificate.
//
// Fails (bad_file) with "FILE:LINE: key 'reference.serial' is missing" on the first problem, and
// when the logo cannot be used. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/base/error.hpp"
#include "services/contract/reference_standard.hpp"
#include "services/views/lab_file/contact_table.hpp"
#include "services/views/lab_file/embedded_picture.hpp"
#include "services/views/language/language.hpp"

namespace dyncal::inline views {

struct Person {
  std::string name;
  std::string role;
  bool main_signer = false;
};

struct Letterhead {
  std::string title;                // of the report
  std::vector<std::string> lines;   // beneath the laboratory's name
  std::vector<std::string> remarks; // paragraphs after the results
  std::string footer;
};

struct LaboratoryFile {
  std::filesystem::path path;
  Contact laboratory;
  std::string accreditation; // code of the laboratory; may be empty
  std::string place;         // of calibrations; empty: its address
  std::optional<EmbeddedPicture> logo;
  Letterhead letterhead;
  std::vector<Person> persons;
  std::optional<Contact> customer;
  std::optional<ReferenceStandard> reference; // where the run does not state its own
  std::vector<CalibratedDevice> equipment;
  Conditions conditions;
  std::vector<std::string> statements;                // of the certificate
  std::vector<Language> languages{Language::english}; // of documents
};

[[nodiscard]] Expected<LaboratoryFile> read_laboratory_file(const std::filesystem::path& path);

// The same from text; `path` is for messages, and the logo is looked for beside it.
[[nodiscard]] Expected<LaboratoryFile> parse_laboratory_file(std::string_view text,
                                                             const std::filesystem::path& path);

} // namespace dyncal::inline views
