// `dyncal certify RUN --lab LAB.toml`: a digital calibration certificate of a stored run.
//
// Writes certificate.xml into the run folder, NAME-certificate.xml beside NAME.json, or what
// --output says; never over an older file. The result is held against store and recording before
// (services/records/provenance); a signed certificate takes its number in the store. Exit status 1
// and one line when something is missing or speaks against it. Belongs to one thread.
#include <fmt/core.h>

#include "services/base/printable_text.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/issued_number.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/language_option.hpp"
#include "services/programs/command/named_sensor.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/provenance/result_provenance.hpp"
#include "services/views/certificate/certificate_file.hpp"
#include "services/views/lab_file/contact_table.hpp"

namespace dyncal::inline programs {
namespace {

struct CertifyOptions {
  CertificateFileRequest file; // without an output: as above
  SigningKey key;              // without names: not signed
  SensorOptions sensor;        // without any: as the run's source describes itself
  NumberOptions number;
};

void add_certify(CLI::App& command, CertifyOptions& options) {
  CertificateRequest& certify = options.file.certificate;
  take_run(command.add_option("RUN", certify.run, "run folder, or a result file (JSON)"))
      ->required();
  command
      .add_option("--lab", certify.laboratory,
                  "laboratory file: who issues it, customer, reference, conditions")
      ->required();
  add_sensor_options(command, options.sensor);
  command.add_option("--tolerances", certify.tolerances,
                     "tolerance file (default: what the sensor file has of it)");
  command.add_option("--channel", certify.channels,
                     "channel to certify (repeatable; default: all that respond)");
  add_language_option(command, certify.languages);
  add_number_options(command, options.number);
  command
      .add_option("--performed", certify.performed,
                  "day of the measurement, YYYY-MM-DD, of a run that does not know it")
      ->check(CLI::Validator(
          [](const std::string& text) { return is_date(text) ? std::string() : date_rule(text); },
          "DATE"));
  CLI::Option* key =
      command.add_option("--key", options.key.key,
                         "private key to sign with: a PEM file, or pkcs11:token=...;object=... of "
                         "one in a token (default: none)");
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
  for (const TranslatedText& statement : contents.provenance) {
    fmt::print("{}\n", statement.english);
  }
  if (!request.key && !contents.number.empty()) {
    fmt::print("number {} is not taken: the certificate is not signed\n",
               one_line(contents.number));
  }
  for (const TranslatedText& objection : contents.objections) {
    fmt::print("forced in spite of: {}\n", objection.english);
  }
}

// What is signed is entered in the register.
auto entering(const std::string& place) {
  return [place](const CertificateFileRequest& request, const CertificateContents& contents,
                 const std::string& text) -> Expected<void> {
    if (!request.key || contents.number.empty()) {
      return {};
    }
    IssuedDocument document = document_of(contents.result, text, request.output);
    document.number = contents.number;
    document.kind = "DCC";
    document.identifier = contents.identifier;
    document.replaces = contents.replaces;
    document.serial = contents.sensor.serial;
    return enter_document(place, document);
  };
}

Expected<void> gather(CertifyOptions& options, const std::string& place,
                      const std::stop_token& stop) {
  CertificateRequest& certify = options.file.certificate;
  DYNCAL_TRY(const auto replaced, replaced_document(options.number, place, "DCC"));
  DYNCAL_TRY(certify.held,
             with_progress("holding the result against its recording", [&](const auto& count) {
               return read_held_result(certify.run, place, count, stop);
             }));
  if (options.file.key) {
    DYNCAL_TRY(require_proof(certify.held));
  }
  DYNCAL_TRY(certify.sensor, sensor_of_run(options.sensor, certify.held.result, place));
  certify.number = options.number.number;
  certify.replaces = options.number.replaces;
  if (replaced) {
    certify.replaced_identifier = replaced->identifier;
    certify.replaced_sha256 = replaced->sha256;
  }
  return {};
}

Expected<void> run_certify(CertifyOptions& options, const std::stop_token& stop) {
  CertificateFileRequest& request = options.file;
  if (request.output.empty()) {
    request.output = file_beside_run(request.certificate.run, "certificate.xml");
  }
  if (!options.key.key.empty()) {
    request.key = options.key;
  }
  const std::string place = options.number.store.text_for(request.certificate.run);
  DYNCAL_TRY(gather(options, place, stop));
  request.enter = entering(place);
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
