#include "services/views/certificate/verification.hpp"

#include <fmt/core.h>

#include "services/base/whole_file.hpp"
#include "services/views/certificate/certificate_contents.hpp"
#include "services/views/certificate/dcc.hpp"
#include "services/views/certificate/schema.hpp"
#include "services/views/certificate/signature.hpp"
#include "services/views/certificate/stated_results.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::uintmax_t max_certificate_bytes = 64U << 20U;

VerificationFinding failed(Verification question, std::string sentence) {
  return {question, false, std::move(sentence)};
}

VerificationFinding held(Verification question, std::string sentence) {
  return {question, true, std::move(sentence)};
}

std::string day_of_issue(const XmlDocument& document) {
  const auto dates = document.root().descendants("issueDate", dcc_namespace);
  return dates.empty() ? "" : dates.front().text();
}

std::string declared(const XmlDocument& document, const std::string& type) {
  for (const XmlElement& data : document.root().descendants("metaData", dcc_namespace)) {
    if (data.attribute("refType") == type) {
      const auto declaration = data.child("declaration");
      const auto content = declaration ? declaration->child("content") : std::nullopt;
      return content ? content->text() : ""; // the same in every language
    }
  }
  return "";
}

VerificationFinding check_schema(const VerificationRequest& request, const XmlDocument& document) {
  const std::string name = request.certificate.string();
  if (!document.root().is("digitalCalibrationCertificate", dcc_namespace)) {
    return failed(Verification::schema, fmt::format("{}: is XML, but not a digital calibration "
                                                    "certificate",
                                                    name));
  }
  const auto schema = DccSchema::load(request.schema);
  if (!schema) {
    return failed(Verification::schema, schema.error().message);
  }
  const auto valid = schema->validate(document, name);
  return valid ? held(Verification::schema, "valid against the schema of DCC 3.3.0")
               : failed(Verification::schema, valid.error().message);
}

VerificationFinding check_trust(const VerificationRequest& request, const XmlDocument& document,
                                const Signer& signer) {
  if (request.trusted.empty()) {
    return failed(
        Verification::signer,
        fmt::format("signer name \"{}\" is not confirmed by any trusted certificate: name "
                    "the certificate of the laboratory or of its CA with --trust",
                    signer.subject));
  }
  const auto known = check_signer(document, request.trusted, day_of_issue(document));
  return known ? held(Verification::signer,
                      fmt::format("signed by {}, known by {}; the certificate is valid until {}",
                                  signer.subject, request.trusted.string(), signer.valid_until))
               : failed(Verification::signer, known.error().message);
}

void add_signature(const VerificationRequest& request, const XmlDocument& document,
                   std::vector<VerificationFinding>& findings) {
  const auto signer = check_signature(document);
  if (!signer) {
    const bool is_unsigned = signer.error().code == SignatureProblem::not_signed;
    findings.push_back(failed(is_unsigned ? Verification::is_signed : Verification::signature,
                              signer.error().message));
    return;
  }
  findings.push_back(held(
      Verification::signature,
      fmt::format("the {} signature is intact and over the whole document", signer->algorithm)));
  findings.push_back(check_trust(request, document, *signer));
}

// The language of the certificate whose names of results it is known by: that of their first text.
Language language_of(const XmlDocument& document) {
  const auto used = document.root().descendants("usedLangCodeISO639_1", dcc_namespace);
  const auto is_used = [&](Language language) {
    return std::ranges::any_of(
        used, [&](const XmlElement& code) { return code.text() == code_of(language); });
  };
  const auto* const first = std::ranges::find_if(all_languages, is_used);
  return first == std::end(all_languages) ? Language::english : *first;
}

// The channels that the certificate states, by the names of its results.
std::vector<std::string> channels_of(const StatedResults& certificate, Language language) {
  const std::string beginning = result_name("", language);
  std::vector<std::string> channels;
  for (const auto& [name, quantities] : certificate) {
    if (name.starts_with(beginning)) {
      channels.push_back(name.substr(beginning.size()));
    }
  }
  return channels;
}

Expected<StatedResults> results_of_run(const StoredResult& run,
                                       const std::vector<std::string>& channels,
                                       Language language) {
  DYNCAL_TRY(const auto certified, certified_channels(run, channels));
  const XmlDocument made = XmlDocument::make_dcc();
  add_results(made.root(), certified, false);
  keep_languages(made.root(), {language});
  return *stated_results(*made.root().child("results"));
}

VerificationFinding check_numbers(const XmlDocument& document, const StoredResult& run) {
  const auto results = document.root().descendants("results", dcc_namespace);
  const auto certificate = results.size() == 1 ? stated_results(results.front()) : std::nullopt;
  const Language language = language_of(document);
  const auto channels =
      certificate ? channels_of(*certificate, language) : std::vector<std::string>();
  if (channels.empty()) {
    return failed(Verification::numbers, "the certificate has no results as dyncal states them");
  }
  const auto expected = results_of_run(run, channels, language);
  if (!expected) {
    return failed(Verification::numbers,
                  "the run does not give what the certificate states: " + expected.error().message);
  }
  if (const auto difference = difference_between(*certificate, *expected)) {
    return failed(Verification::numbers, "the numbers are not those of the run: " + *difference);
  }
  if (declared(document, "dyncal_resultSha256") != run.sha256) {
    return failed(Verification::numbers,
                  fmt::format("the numbers agree, but {} is not the file that the certificate was "
                              "made of: its SHA-256 is another",
                              run.file.string()));
  }
  return held(Verification::numbers,
              fmt::format("{} numbers of {} channels are those of {}, whose SHA-256 is as stated",
                          count_of_values(*certificate), channels.size(), run.file.string()));
}

} // namespace

const char* to_string(Verification question) {
  switch (question) {
  case Verification::readable:
    return "file";
  case Verification::schema:
    return "schema";
  case Verification::is_signed:
  case Verification::signature:
    return "signature";
  case Verification::signer:
    return "signer";
  case Verification::numbers:
    return "numbers";
  case Verification::measured:
    return "measured";
  case Verification::issued:
    return "issued";
  }
  return "?";
}

Expected<std::vector<VerificationFinding>> verify(const VerificationRequest& request) {
  DYNCAL_TRY(const auto text, read_whole_file(request.certificate, max_certificate_bytes));
  std::vector<VerificationFinding> findings;
  const auto document = XmlDocument::parse(text, request.certificate.string());
  if (!document) {
    findings.push_back(failed(Verification::readable, document.error().message));
    return findings;
  }
  findings.push_back(check_schema(request, *document));
  add_signature(request, *document, findings);
  if (!request.run.empty()) {
    DYNCAL_TRY(const auto run, read_values(request.run));
    findings.push_back(check_numbers(*document, run));
  }
  for (const XmlElement& statement : document->root().descendants("statement", dcc_namespace)) {
    if (statement.attribute("refType") == "dyncal_forced") {
      findings.push_back(held(Verification::readable,
                              "the certificate says of itself that it was forced in spite of "
                              "objections: read its first statement"));
    }
  }
  return findings;
}

} // namespace dyncal::inline views
