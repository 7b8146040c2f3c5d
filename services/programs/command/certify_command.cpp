// `dyncal certify RUN --lab LAB.toml`: a digital calibration certificate of a stored run.
//
// Writes certificate.xml into the run folder, NAME-certificate.xml beside NAME.json, or what
// --output says; never over an older file. Exit status 1 and one line when something is missing or
// speaks against it. Belongs to one thread.
#include <fmt/core.h>

#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/certificate/certificate_file.hpp"
#include "services/views/lab_file/contact_table.hpp"

namespace dyncal::inline programs {
namespace {

struct CertifyOptions {
  CertificateFileRequest file; // without an output: as above
  SigningKey key;              // without names: not signed
};

void add_certify(CLI::App& command, CertifyOptions& options) {
  CertificateRequest& certify = options.file.certificate;
  take_run(command.add_option("RUN", certify.run, "run folder, or a result file (JSON)"))
      ->required();
  command
      .add_option("--lab", certify.laboratory,
                  "laboratory file: who issues it, customer, reference, conditions")
      ->required();
  command.add_option("--sensor", certify.sensor,
                     "sensor file (default: as the run's source describes itself)");
  command.add_option("--channel", certify.channels,
                     "channel to certify (repeatable; default: all that respond)");
  command.add_option("--number", certify.number,
                     "number of the certificate (default: that of the sensor file)");
  command
      .add_option("--performed", certify.performed,
                  "day of the measurement, YYYY-MM-DD (default: from the run)")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return is_date(text) ? std::string() : "must be a date, for example 2026-03-01";
          },
          "DATE"));
  CLI::Option* key =
      command.add_option("--key", options.key.key, "private key to sign with, PEM (default: none)");
  CLI::Option* certificate = command.add_option(
      "--certificate", options.key.certificate,
      "X.509 certificate of the key, PEM; others up to the CA may follow it in the file");
  key->needs(certificate);
  certificate->needs(key);
  command.add_option("--schema", options.file.schema,
                     "dcc.xsd to hold it against (default: the installed one)");
  command.add_option("--output", options.file.output,
                     "file to write (default: certificate.xml in the run folder, "
                     "NAME-certificate.xml for NAME.json)");
  command.add_flag("--force", certify.force,
                   "issue despite losses, missing values or blocking flags; recorded in the "
                   "certificate");
}

void print_made(const CertificateFileRequest& request, const CertificateContents& contents) {
  std::size_t values = 0;
  for (const CertifiedChannel& channel : contents.channels) {
    values += channel.values.size();
  }
  fmt::print("wrote {}: DCC 3.3.0, {} channels, {} values, {}\n", request.output.string(),
             contents.channels.size(), values, request.key ? "signed" : "NOT SIGNED (--key)");
  for (const std::string& objection : contents.objections) {
    fmt::print("forced in spite of: {}\n", objection);
  }
}

Expected<void> run_certify(CertifyOptions& options) {
  CertificateFileRequest& request = options.file;
  if (request.output.empty()) {
    request.output = file_beside_run(request.certificate.run, "certificate.xml");
  }
  if (!options.key.key.empty()) {
    request.key = options.key;
  }
  DYNCAL_TRY(const auto made, with_progress("making the certificate", [&](const auto&) {
               return write_certificate(request);
             }));
  print_made(request, made);
  return {};
}

const Command certify_command{220, "certify",
                              "make a digital calibration certificate (DCC 3.3.0) of a stored run",
                              add_certify, run_certify};

} // namespace
} // namespace dyncal::inline programs
