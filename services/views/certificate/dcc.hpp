// The digital calibration certificate (DCC 3.3.0, https://ptb.de/dcc) of gathered contents, without
// its signature. Quantities are D-SI 2.2.1 lists with units; U, k and coverage probability stand
// with each value; phase is a hybrid of radian and degree.
//
// Texts are written in all languages, and those that the certificate is not in are taken out at the
// end. What files and instruments say stands in each language as it is.
//
// In a certificate that was forced, the first statement says so with every objection, and every
// result repeats it. Plain functions, any thread.
#pragma once

#include "services/views/certificate/certificate_contents.hpp"
#include "services/views/certificate/xml_document.hpp"

namespace dyncal::inline views {

[[nodiscard]] XmlDocument dcc_of(const CertificateContents& contents);

// Parts of it, each in a file of its own.
void add_administrative_data(XmlElement root, const CertificateContents& contents);
void add_measurement_results(XmlElement root, const CertificateContents& contents);
// dcc:results: one dcc:result a channel, whose name is result_name(channel) in each language.
void add_results(XmlElement measurement_result, const std::vector<CertifiedChannel>& channels,
                 bool forced);
[[nodiscard]] std::string result_name(const std::string& channel, Language language);
// Takes the texts of other languages out.
void keep_languages(XmlElement root, const std::vector<Language>& languages);

// dcc:name (or another element of that type) with a text in each language, and such a text of an
// element that there is.
void add_text(XmlElement parent, std::string_view element, const TranslatedText& text);
void add_text(XmlElement parent, std::string_view element, const Sentence& text);
void add_text(XmlElement parent, std::string_view element, std::string_view text);
void add_content(XmlElement element, const TranslatedText& text);
// The text in one line; nothing where it is empty.
void add_line(XmlElement parent, std::string_view element, std::string_view text);
// dcc:location and what stands before it in a contact.
void add_contact(XmlElement contact, const Contact& from);
// dcc:manufacturer and dcc:model, as far as they are known.
void add_make(XmlElement parent, const std::string& manufacturer, const std::string& model);
// `refType` may be empty.
void add_identification(XmlElement list, std::string_view type, std::string_view issuer,
                        const std::string& value, const Sentence& name);
// "v0.2.0" of a text with such a number: what the rules for DCCs take for a release, a letter and
// up to four numbers. Nothing of another text.
[[nodiscard]] std::optional<std::string> release_of(const std::string& text);
// Of a text "dyncal 0.2.0 (1a2b3c4)": name, release, and the description, which has a place for the
// whole text.
void add_software(XmlElement list, const std::string& text, const Sentence& description);
// Single-spaced and never empty: what dcc:notEmptyStringType takes.
[[nodiscard]] std::string single_line(std::string_view text, std::string_view otherwise = "-");

} // namespace dyncal::inline views
