// The digital calibration certificate (DCC 3.3.0, https://ptb.de/dcc) of gathered contents, without
// its signature. Quantities are D-SI 2.2.1 lists with units; U, k and coverage probability stand
// with each value; phase is a hybrid of radian and degree.
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
// dcc:results: one dcc:result a channel, whose name is result_name(channel).
void add_results(XmlElement measurement_result, const std::vector<CertifiedChannel>& channels,
                 bool forced);
[[nodiscard]] std::string result_name(const std::string& channel);

// dcc:name (or another element of that type) with one text in English.
void add_text(XmlElement parent, std::string_view element, std::string_view text);
// The text in one line; nothing where it is empty.
void add_line(XmlElement parent, std::string_view element, std::string_view text);
// dcc:location and what stands before it in a contact.
void add_contact(XmlElement contact, const Contact& from);
// dcc:manufacturer and dcc:model, as far as they are known.
void add_make(XmlElement parent, const std::string& manufacturer, const std::string& model);
// `refType` may be empty.
void add_identification(XmlElement list, std::string_view type, std::string_view issuer,
                        const std::string& value, std::string_view name);
// "v0.2.0" of a text with such a number: what the rules for DCCs take for a release, a letter and
// up to four numbers. Nothing of another text.
[[nodiscard]] std::optional<std::string> release_of(const std::string& text);
// Of a text "dyncal 0.2.0 (1a2b3c4)": name, release, and the whole text.
void add_software(XmlElement list, const std::string& text, std::string_view description);
// Single-spaced and never empty: what dcc:notEmptyStringType takes.
[[nodiscard]] std::string single_line(std::string_view text, std::string_view otherwise = "-");

} // namespace dyncal::inline views
