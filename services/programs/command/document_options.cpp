#include "services/programs/command/document_options.hpp"

#include <CLI/CLI.hpp>

#include "services/programs/command/keep_options.hpp"
#include "services/views/lab_file/contact_table.hpp"

namespace dyncal::inline programs {
namespace {

void add_report(CLI::App& app, ReportCommand& report) {
  CLI::App* command = app.add_subcommand(
      "report", "make a report of a stored run, HTML and PDF: values with U and k, figures, "
                "budgets, flags, conditions, signature block");
  take_run(
      *command->add_option("RUN", report.run, "run folder, or a result file (JSON)")->required());
  command->add_option("--lab", report.laboratory, "laboratory file: letterhead, persons, texts");
  command->add_option("--sensor", report.sensor, "sensor file: what was calibrated, and for whom");
  command->add_option("--channel", report.channels,
                      "channel to report (repeatable; default: all that respond)");
  command->add_option("--output", report.output,
                      "name of the files without .html and .pdf (default: report in the run "
                      "folder, NAME-report for NAME.json)");
  command->add_flag("--no-pdf", report.no_pdf, "write the HTML alone");
  command->add_flag("--force", report.force,
                    "report although a closure is open; the first page says so");
}

void add_certify(CLI::App& app, CertifyCommand& certify) {
  CLI::App* command = app.add_subcommand(
      "certify", "make a digital calibration certificate (DCC 3.3.0) of a stored run");
  take_run(
      *command->add_option("RUN", certify.run, "run folder, or a result file (JSON)")->required());
  command
      ->add_option("--lab", certify.laboratory,
                   "laboratory file: who issues it, customer, reference, conditions")
      ->required();
  command->add_option("--sensor", certify.sensor,
                      "sensor file (default: as the run's source describes itself)");
  command->add_option("--channel", certify.channels,
                      "channel to certify (repeatable; default: all that respond)");
  command->add_option("--number", certify.number,
                      "number of the certificate (default: that of the sensor file)");
  command
      ->add_option("--performed", certify.performed,
                   "day of the measurement, YYYY-MM-DD (default: from the run)")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return is_date(text) ? std::string() : "must be a date, for example 2026-03-01";
          },
          "DATE"));
  CLI::Option* key =
      command->add_option("--key", certify.key, "private key to sign with, PEM (default: none)");
  CLI::Option* certificate = command->add_option(
      "--certificate", certify.certificate,
      "X.509 certificate of the key, PEM; others up to the CA may follow it in the file");
  key->needs(certificate);
  certificate->needs(key);
  command->add_option("--schema", certify.schema,
                      "dcc.xsd to hold it against (default: the installed one)");
  command->add_option("--output", certify.output,
                      "file to write (default: certificate.xml in the run folder, "
                      "NAME-certificate.xml for NAME.json)");
  command->add_flag("--force", certify.force,
                    "issue despite losses, missing values or blocking flags; recorded in the "
                    "certificate");
}

void add_verify(CLI::App& app, VerifyCommand& verify) {
  CLI::App* command = app.add_subcommand(
      "verify", "check a digital calibration certificate: schema, signature, signer, numbers");
  command->add_option("FILE", verify.certificate, "certificate (DCC, XML)")->required();
  take_run(*command->add_option("--run", verify.run,
                                "run folder or result file that its numbers should be those of"));
  command->add_option("--trust", verify.trusted,
                      "X.509 certificates, PEM, of the laboratory or its CA, one or more");
  command->add_option("--schema", verify.schema,
                      "dcc.xsd to hold it against (default: the installed one)");
}

} // namespace

void add_documents(CLI::App& app, DocumentCommands& commands) {
  add_report(app, commands.report);
  add_certify(app, commands.certify);
  add_verify(app, commands.verify);
}

bool has_document_command(const CLI::App& app) {
  return app.got_subcommand("report") || app.got_subcommand("certify") ||
         app.got_subcommand("verify");
}

int run_document_command(const CLI::App& app, const DocumentCommands& commands) {
  if (app.got_subcommand("certify")) {
    return run_certify(commands.certify);
  }
  return app.got_subcommand("verify") ? run_verify(commands.verify) : run_report(commands.report);
}

} // namespace dyncal::inline programs
