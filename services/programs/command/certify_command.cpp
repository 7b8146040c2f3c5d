#include "services/programs/command/certify_command.hpp"

#include <fmt/core.h>

#include "services/daemon/program/program.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/views/certificate/certificate_file.hpp"

namespace dyncal::inline programs {
namespace {

std::filesystem::path output_of(const CertifyCommand& command) {
  if (!command.output.empty()) {
    return command.output;
  }
  std::error_code unknown;
  return std::filesystem::is_directory(command.run, unknown)
             ? command.run / "certificate.xml"
             : command.run.parent_path() / (command.run.stem().string() + "-certificate.xml");
}

CertificateFileRequest request_of(const CertifyCommand& command) {
  CertificateFileRequest request{.certificate = {.run = command.run,
                                                 .laboratory = command.laboratory,
                                                 .sensor = command.sensor,
                                                 .channels = command.channels,
                                                 .number = command.number,
                                                 .performed = command.performed,
                                                 .force = command.force},
                                 .key = std::nullopt,
                                 .schema = command.schema,
                                 .output = output_of(command)};
  if (!command.key.empty()) {
    request.key = {command.key, command.certificate};
  }
  return request;
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

} // namespace

int run_certify(const CertifyCommand& command) {
  const CertificateFileRequest request = request_of(command);
  const auto made = [&] {
    const WorkProgress progress("making the certificate");
    return write_certificate(request);
  }();
  if (!made) {
    return report_error(made.error());
  }
  print_made(request, *made);
  return 0;
}

} // namespace dyncal::inline programs
