#include "services/views/certificate/dcc.hpp"

namespace dyncal::inline views {

std::string single_line(std::string_view text, std::string_view otherwise) {
  std::string line;
  bool is_space = false;
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == '\n' || c == '\r') {
      is_space = !line.empty();
      continue;
    }
    line += is_space ? " " : "";
    line += c;
    is_space = false;
  }
  return line.empty() ? std::string(otherwise) : line;
}

void add_text(XmlElement parent, std::string_view element, std::string_view text) {
  parent.add(element).add("dcc:content", text).attribute("lang", "en");
}

void add_contact(XmlElement contact, const Contact& from) {
  const auto add_line = [](XmlElement parent, std::string_view element, const std::string& text) {
    if (!text.empty()) {
      parent.add(element, single_line(text));
    }
  };
  add_text(contact, "dcc:name", from.name);
  add_line(contact, "dcc:eMail", from.email);
  add_line(contact, "dcc:phone", from.phone);
  add_line(contact, "dcc:link", from.web);
  XmlElement location = contact.add("dcc:location");
  add_line(location, "dcc:street", from.street);
  add_line(location, "dcc:streetNo", from.street_number);
  add_line(location, "dcc:postCode", from.post_code);
  add_line(location, "dcc:city", from.city);
  add_line(location, "dcc:countryCode", from.country);
}

XmlDocument dcc_of(const CertificateContents& contents) {
  XmlDocument document = XmlDocument::make_dcc();
  add_administrative_data(document.root(), contents);
  add_measurement_results(document.root(), contents);
  return document;
}

} // namespace dyncal::inline views
