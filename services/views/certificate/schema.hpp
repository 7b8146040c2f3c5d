// Holds documents against the schema of the DCC, without a network: the schema's files come with
// the program (deploy/third-party/dcc), and while they are read nothing outside their folder is
// opened.
//
// Fails (bad_file): the schema is not there or cannot be read (the sentence says where it was
// looked for); the document is not valid (FILE:LINE and the first reason). One thread at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "services/base/error.hpp"
#include "services/views/certificate/xml_document.hpp"

struct _xmlSchema; // NOLINT(readability-identifier-naming): of libxml2

namespace dyncal::inline views {

class DccSchema {
public:
  // `path` of dcc.xsd; empty: that which was installed with the program.
  [[nodiscard]] static Expected<DccSchema> load(const std::filesystem::path& path);

  // `name` is for messages.
  [[nodiscard]] Expected<void> validate(const XmlDocument& document, const std::string& name) const;

private:
  struct Free {
    void operator()(_xmlSchema* schema) const;
  };
  explicit DccSchema(_xmlSchema* schema) : schema_(schema) {}

  std::unique_ptr<_xmlSchema, Free> schema_;
};

// share/dyncal/dcc/v3.3.0/dcc.xsd beside the folder of the running program.
[[nodiscard]] std::filesystem::path installed_schema();

} // namespace dyncal::inline views
