#include "services/views/certificate/schema.hpp"

#include <fmt/core.h>
#include <libxml/parser.h>
#include <libxml/xmlschemas.h>

#include "services/daemon/program/child_process.hpp"

namespace dyncal::inline views {
namespace {

// The folder that libxml2 may open files of; empty: none.
std::filesystem::path& open_folder() {
  static std::filesystem::path folder;
  return folder;
}

bool may_open(const char* url) {
  if (url == nullptr || open_folder().empty()) {
    return false;
  }
  std::error_code unknown;
  const std::filesystem::path path = std::filesystem::canonical(url, unknown);
  return !unknown && path.string().starts_with(open_folder().string() + "/");
}

xmlExternalEntityLoader& libxml_loader() {
  static xmlExternalEntityLoader loader = xmlGetExternalEntityLoader();
  return loader;
}

// In place of libxml2's own, which opens whatever file a document names.
xmlParserInput* guarded_loader(const char* url, const char* id, xmlParserCtxt* context) {
  return may_open(url) ? libxml_loader()(url, id, context) : nullptr;
}

// Only files of one folder can be opened while it lives, afterwards none.
class OpenFolder {
public:
  explicit OpenFolder(const std::filesystem::path& folder) {
    libxml_loader();
    xmlSetExternalEntityLoader(guarded_loader);
    std::error_code unknown;
    open_folder() = std::filesystem::canonical(folder, unknown);
  }
  ~OpenFolder() { open_folder().clear(); }
  OpenFolder(const OpenFolder&) = delete;
  OpenFolder& operator=(const OpenFolder&) = delete;
};

struct FirstProblem {
  std::string sentence;
  int line = 0;
};

void keep_first(void* context, xmlError* error) {
  auto& first = *static_cast<FirstProblem*>(context);
  if (first.sentence.empty() && error != nullptr && error->message != nullptr) {
    first.sentence = error->message;
    first.sentence.erase(first.sentence.find_last_not_of("\r\n ") + 1);
    first.line = error->line;
  }
}

} // namespace

std::filesystem::path installed_schema() {
  return program_folder().parent_path() / "share" / "dyncal" / "dcc" / "v3.3.0" / "dcc.xsd";
}

void DccSchema::Free::operator()(_xmlSchema* schema) const {
  xmlSchemaFree(schema);
}

Expected<DccSchema> DccSchema::load(const std::filesystem::path& path) {
  const std::filesystem::path file = path.empty() ? installed_schema() : path;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the schema of the DCC is not there; install all of dyncal, or "
                            "name its dcc.xsd with --schema",
                            file.string()));
  }
  // Its imports are relative to its folder's parent.
  const OpenFolder open(std::filesystem::absolute(file, unknown).parent_path().parent_path());
  FirstProblem problem;
  xmlSchemaParserCtxt* context = xmlSchemaNewParserCtxt(file.c_str());
  xmlSchemaSetParserStructuredErrors(context, keep_first, &problem);
  xmlSchema* schema = xmlSchemaParse(context);
  xmlSchemaFreeParserCtxt(context);
  if (schema == nullptr) {
    return fail(ErrorCode::bad_file, fmt::format("{}:{}: the schema cannot be read: {}",
                                                 file.string(), problem.line, problem.sentence));
  }
  return DccSchema(schema);
}

Expected<void> DccSchema::validate(const XmlDocument& document, const std::string& name) const {
  FirstProblem problem;
  xmlSchemaValidCtxt* context = xmlSchemaNewValidCtxt(schema_.get());
  xmlSchemaSetValidStructuredErrors(context, keep_first, &problem);
  const OpenFolder none{std::filesystem::path()};
  const int result = xmlSchemaValidateDoc(context, document.get());
  xmlSchemaFreeValidCtxt(context);
  if (result != 0) {
    return fail(ErrorCode::bad_file, fmt::format("{}:{}: not valid against DCC 3.3.0: {}", name,
                                                 problem.line, problem.sentence));
  }
  return {};
}

} // namespace dyncal::inline views
