#include "services/views/certificate/certificate_file.hpp"

#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/views/certificate/dcc.hpp"
#include "services/views/certificate/schema.hpp"

namespace dyncal::inline views {
namespace {

Expected<void> check_name(const std::filesystem::path& output) {
  std::error_code unknown;
  if (std::filesystem::exists(output, unknown)) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: exists already, and a certificate is not overwritten; name "
                            "another file with --output",
                            output.string()));
  }
  return check_output_file(output);
}

// As a reader of the file will see it.
Expected<void> check_text(const std::string& text, const CertificateFileRequest& request,
                          const DccSchema& schema) {
  const std::string name = request.output.string();
  DYNCAL_TRY(const auto document, XmlDocument::parse(text, name));
  DYNCAL_TRY(schema.validate(document, name));
  if (request.key) {
    if (const auto signer = check_signature(document); !signer) {
      return fail(ErrorCode::bad_file, fmt::format("{}: {}", name, signer.error().message));
    }
  }
  return {};
}

} // namespace

Expected<CertificateContents> write_certificate(const CertificateFileRequest& request) {
  DYNCAL_TRY(check_name(request.output));
  DYNCAL_TRY(const auto schema, DccSchema::load(request.schema));
  auto contents = gather_certificate(request.certificate);
  if (!contents) {
    return contents;
  }
  XmlDocument document = dcc_of(*contents);
  if (request.key) {
    DYNCAL_TRY(sign(document, *request.key));
  }
  const std::string text = document.text();
  DYNCAL_TRY(check_text(text, request, schema));
  if (request.enter) {
    DYNCAL_TRY(request.enter(request, *contents, text));
  }
  DYNCAL_TRY(write_output_file(request.output, text));
  return contents;
}

} // namespace dyncal::inline views
