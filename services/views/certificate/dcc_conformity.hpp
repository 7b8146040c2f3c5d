// Conformity in a DCC: the decision rule and the verdict as statements, and for every channel and
// limit a dcc:metaData with what each value was decided to be (refType basic_conformity). A value
// that is undecided is noPass; one without U is named and has no number. Plain functions, any
// thread.
#pragma once

#include <optional>

#include "services/views/certificate/xml_document.hpp"
#include "services/views/conformity/conformity.hpp"

namespace dyncal::inline views {

// Into dcc:statements, and into dcc:measurementMetaData; nothing of nothing.
void add_conformity_statements(XmlElement list, const std::optional<ConformityReport>& report);
void add_conformity(XmlElement list, const std::optional<ConformityReport>& report);

} // namespace dyncal::inline views
