// `dyncal report`, `certify`, `verify`: the command line of what is made of stored runs for people.
#pragma once

#include "services/programs/command/certify_command.hpp"
#include "services/programs/command/report_command.hpp"
#include "services/programs/command/verify_command.hpp"

namespace CLI { // NOLINT(readability-identifier-naming): of the library
class App;
}

namespace dyncal::inline programs {

struct DocumentCommands {
  ReportCommand report;
  CertifyCommand certify;
  VerifyCommand verify;
};

// The options are kept in `commands`, which must outlive the parsing.
void add_documents(CLI::App& app, DocumentCommands& commands);

// Whether the command line has one of these commands.
[[nodiscard]] bool has_document_command(const CLI::App& app);

// REQUIRES: has_document_command(app).
[[nodiscard]] int run_document_command(const CLI::App& app, const DocumentCommands& commands);

} // namespace dyncal::inline programs
