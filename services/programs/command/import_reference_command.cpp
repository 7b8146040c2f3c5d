// `dyncal import-reference CERTIFICATE.xml`: makes a reference file of the digital calibration
// certificate of a transducer (services/views/certificate/reference_certificate.hpp). It never
// overwrites a file. Belongs to one thread.
#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/programs/command/command.hpp"
#include "services/views/certificate/reference_certificate.hpp"

namespace dyncal::inline programs {
namespace {

struct ImportReferenceOptions {
  std::filesystem::path certificate;
  std::filesystem::path output = "reference.toml";
  std::string table;
};

void add_import_reference(CLI::App& command, ImportReferenceOptions& options) {
  command.add_option("CERTIFICATE", options.certificate, "DCC, XML")->required();
  command.add_option("--output", options.output, "file to write")->capture_default_str();
  command.add_option("--table", options.table, "of several tables, the name of one");
}

Expected<int> run_import_reference(const ImportReferenceOptions& options,
                                   const std::stop_token& /*stop*/) {
  DYNCAL_TRY(const auto text, reference_file_of(options.certificate, options.table));
  DYNCAL_TRY(write_new_file(options.output, text));
  fmt::print("{} is written; add what its comments ask for, then name it in the bench file: "
             "[corrections] reference = \"{}\". Whether the certificate is genuine tells: dyncal "
             "verify {} --trust ISSUER.pem\n",
             options.output.string(), options.output.string(), options.certificate.string());
  return 0;
}

const Command import_reference_command{45, "import-reference",
                                       "make a reference file of a digital calibration certificate",
                                       add_import_reference, run_import_reference};

} // namespace
} // namespace dyncal::inline programs
