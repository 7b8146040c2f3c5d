#include "services/views/certificate/dcc.hpp"

#include <algorithm>
#include <regex>

#include <fmt/format.h>

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

void add_content(XmlElement element, const TranslatedText& text) {
  for (const Language language : all_languages) {
    element.add("dcc:content", text.in(language)).attribute("lang", code_of(language));
  }
}

void add_text(XmlElement parent, std::string_view element, const TranslatedText& text) {
  add_content(parent.add(element), text);
}

void add_text(XmlElement parent, std::string_view element, const Sentence& text) {
  add_text(parent, element, text.translated());
}

void add_text(XmlElement parent, std::string_view element, std::string_view text) {
  add_text(parent, element, TranslatedText{std::string(text), std::string(text)});
}

void keep_languages(XmlElement root, const std::vector<Language>& languages) {
  for (XmlElement& content : root.descendants("content", dcc_namespace)) {
    const std::string code = content.attribute("lang");
    if (std::ranges::find(languages, code, code_of) == languages.end()) {
      content.remove();
    }
  }
}

void add_line(XmlElement parent, std::string_view element, std::string_view text) {
  if (!text.empty()) {
    parent.add(element, single_line(text));
  }
}

void add_contact(XmlElement contact, const Contact& from) {
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

void add_make(XmlElement parent, const std::string& manufacturer, const std::string& model) {
  if (!manufacturer.empty()) {
    add_text(parent.add("dcc:manufacturer"), "dcc:name", manufacturer);
  }
  add_line(parent, "dcc:model", model);
}

void add_identification(XmlElement list, std::string_view type, std::string_view issuer,
                        const std::string& value, const Sentence& name) {
  XmlElement identification = list.add("dcc:identification").attribute("refType", type);
  identification.add("dcc:issuer", issuer);
  identification.add("dcc:value", single_line(value));
  add_text(identification, "dcc:name", name);
}

std::optional<std::string> release_of(const std::string& text) {
  static const std::regex version(R"((^|[^0-9.])((\d{1,3}\.){0,3}\d{1,3})($|[^0-9.]))");
  std::smatch found;
  return std::regex_search(text, found, version) ? std::optional("v" + found[2].str())
                                                 : std::nullopt;
}

void add_software(XmlElement list, const std::string& text, const Sentence& description) {
  const std::string line = single_line(text);
  XmlElement software = list.add("dcc:software");
  add_text(software, "dcc:name", line.substr(0, line.find(' ')));
  software.add("dcc:release", release_of(line).value_or("v0"));
  software.add("dcc:type", "application");
  add_text(software, "dcc:description",
           in_all_languages([&](Language language) { return description(language, line); }));
}

XmlDocument dcc_of(const CertificateContents& contents) {
  XmlDocument document = XmlDocument::make_dcc();
  add_administrative_data(document.root(), contents);
  add_measurement_results(document.root(), contents);
  keep_languages(document.root(), contents.languages);
  return document;
}

} // namespace dyncal::inline views
