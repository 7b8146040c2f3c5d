// X.509 certificates within signed XML, and what people are shown of one. Any thread.
#pragma once

#include <string>

#include <openssl/x509.h>

#include "services/security/pem_file.hpp"
#include "services/views/certificate/xml_document.hpp"

namespace dyncal::inline views {

// Those within an X509Data element, in their order; empty when one cannot be read.
[[nodiscard]] Certificates certificates_in(const XmlElement& x509_data);

// "CN=..., O=..." and "2027-03-01"
[[nodiscard]] std::string name_text(const X509_NAME* name);
[[nodiscard]] std::string end_of_validity(const X509* certificate);

} // namespace dyncal::inline views
