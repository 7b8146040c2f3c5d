#include <algorithm>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/views/certificate/dcc.hpp"
#include "services/views/certificate/dcc_conformity.hpp"
#include "services/views/language/certificate_sentences.hpp"
#include "services/views/language/report_sentences.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/daily_check.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

// The certificate whose place this one takes.
void add_replaced(XmlElement core, const CertificateContents& contents) {
  XmlElement change = core.add("dcc:reportAmendedSubstituted");
  change.add("dcc:typeOfChange", "substituted");
  change.add("dcc:replacedUniqueIdentifier", contents.replaced_identifier.empty()
                                                 ? contents.replaces
                                                 : contents.replaced_identifier);
  if (contents.replaced_sha256.empty()) {
    return; // a report on paper
  }
  XmlElement previous = core.add("dcc:previousReport");
  add_text(previous, "dcc:referral", sentences::replaced_certificate);
  previous.add("dcc:referralID", contents.replaces);
  previous.add("dcc:procedure", "SHA-256");
  previous.add("dcc:value", contents.replaced_sha256);
}

void add_core_data(XmlElement parent, const CertificateContents& contents) {
  XmlElement core = parent.add("dcc:coreData");
  core.add("dcc:countryCodeISO3166_1", contents.laboratory.laboratory.country);
  for (const Language language : contents.languages) {
    core.add("dcc:usedLangCodeISO639_1", code_of(language));
  }
  core.add("dcc:mandatoryLangCodeISO639_1", code_of(contents.languages.front()));
  core.add("dcc:uniqueIdentifier", contents.identifier);
  XmlElement identifications = core.add("dcc:identifications");
  if (!contents.number.empty()) {
    add_identification(identifications, "basic_certificateNumber", "calibrationLaboratory",
                       contents.number, sentences::certificate_number);
  }
  add_identification(identifications, "", "calibrationLaboratory",
                     contents.result.bench + " / " + contents.result.run,
                     sentences::bench_slash_run);
  if (!contents.sensor.received.empty()) {
    core.add("dcc:receiptDate", contents.sensor.received);
  }
  core.add("dcc:beginPerformanceDate", contents.began);
  core.add("dcc:endPerformanceDate", contents.ended);
  core.add("dcc:performanceLocation", contents.laboratory.place.empty() ? "laboratory" : "other");
  core.add("dcc:issueDate", contents.issued);
  if (!contents.replaces.empty()) {
    add_replaced(core, contents);
  }
}

void add_item(XmlElement parent, const SensorFile& sensor) {
  XmlElement item = parent.add("dcc:items").add("dcc:item");
  if (sensor.name.empty()) {
    add_text(item, "dcc:name", sentences::digital_sensor);
  } else {
    add_text(item, "dcc:name", sensor.name);
  }
  const auto release = release_of(sensor.firmware);
  if (release) {
    XmlElement software = item.add("dcc:installedSoftwares").add("dcc:software");
    add_text(software, "dcc:name", sentences::firmware_software);
    software.add("dcc:release", *release);
    software.add("dcc:type", "firmware");
    add_text(software, "dcc:description", sensor.firmware);
  }
  add_make(item, sensor.manufacturer, sensor.model);
  XmlElement identifications = item.add("dcc:identifications");
  add_identification(identifications, "basic_serialNo", "manufacturer", sensor.serial,
                     sentences::serial_number);
  if (!release && !sensor.firmware.empty()) {
    add_identification(identifications, "", "manufacturer", sensor.firmware,
                       sentences::firmware_name);
  }
  if (!sensor.owner_identification.empty()) {
    add_identification(identifications, "", "owner", sensor.owner_identification,
                       sentences::owner_identification);
  }
}

void add_laboratory(XmlElement parent, const LaboratoryFile& file) {
  XmlElement laboratory = parent.add("dcc:calibrationLaboratory");
  add_line(laboratory, "dcc:calibrationLaboratoryCode", file.accreditation);
  add_contact(laboratory.add("dcc:contact"), file.laboratory);
}

// Who performed the measurement, beside those who are responsible.
std::vector<Person> persons_of(const CertificateContents& contents) {
  std::vector<Person> persons = contents.laboratory.persons;
  const auto& conducted_by = contents.result.conducted_by;
  if (conducted_by && !conducted_by->name.empty() &&
      std::ranges::find(persons, conducted_by->name, &Person::name) == persons.end()) {
    persons.push_back({.name = conducted_by->name,
                       .role = sentences::performed_measurement(contents.languages.front())});
  }
  return persons;
}

void add_persons(XmlElement parent, const std::vector<Person>& persons) {
  XmlElement list = parent.add("dcc:respPersons");
  for (const Person& person : persons) {
    XmlElement one = list.add("dcc:respPerson");
    add_text(one.add("dcc:person"), "dcc:name", person.name);
    add_line(one, "dcc:role", person.role);
    if (person.main_signer) {
      one.add("dcc:mainSigner", "true");
    }
  }
}

void add_forced(XmlElement list, const std::vector<TranslatedText>& objections) {
  XmlElement statement = list.add("dcc:statement").attribute("refType", "dyncal_forced");
  add_text(statement, "dcc:name", sentences::issued_in_spite);
  XmlElement declaration = statement.add("dcc:declaration");
  add_content(declaration, sentences::certificate_forced.translated());
  for (const TranslatedText& objection : objections) {
    add_content(declaration, objection);
  }
  statement.add("dcc:valid", "false");
}

void add_traceability(XmlElement list, const ReferenceStandard& reference) {
  const CalibratedDevice& device = reference.devices.front();
  XmlElement statement = list.add("dcc:statement").attribute("refType", "basic_traceability");
  add_text(statement, "dcc:name", sentences::traceability);
  statement.add("dcc:traceable", "true");
  statement.add("dcc:reference", single_line(device.certificate));
  add_text(statement, "dcc:declaration", in_all_languages([&](Language language) {
             return sentences::reference_calibrated(
                 language, reference.traceability, device.name, device.serial, device.issued_by,
                 device.certificate,
                 device.issued.empty()
                     ? ""
                     : sentences::of_day(language, day_text(language, device.issued)));
           }));
}

void add_statements(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:statements");
  if (!contents.objections.empty()) {
    add_forced(list, contents.objections);
  }
  add_traceability(list, contents.reference);
  add_text(list.add("dcc:statement").attribute("refType", "dyncal_relatesOnly"), "dcc:declaration",
           sentences::relates_only);
  add_conformity_statements(list, contents.conformity);
  if (const auto& check = contents.result.check) {
    add_text(list.add("dcc:statement").attribute("refType", "dyncal_dailyCheck"), "dcc:declaration",
             in_all_languages([&](Language language) { return sentence_of(*check, language); }));
  }
  for (std::size_t i = 0;
       i < amendment_sentences(contents.result.journal, Language::english).size(); ++i) {
    add_text(list.add("dcc:statement").attribute("refType", "dyncal_amendment"), "dcc:declaration",
             in_all_languages([&](Language language) {
               return amendment_sentences(contents.result.journal, language)[i];
             }));
  }
  for (const TranslatedText& text : contents.provenance) {
    add_text(list.add("dcc:statement").attribute("refType", "dyncal_provenance"), "dcc:declaration",
             text);
  }
  for (const std::string& text : contents.laboratory.statements) {
    add_text(list.add("dcc:statement"), "dcc:declaration", text);
  }
}

} // namespace

void add_administrative_data(XmlElement root, const CertificateContents& contents) {
  XmlElement data = root.add("dcc:administrativeData");
  XmlElement software = data.add("dcc:dccSoftware");
  add_software(software, contents.software, sentences::made_certificate);
  add_core_data(data, contents);
  add_item(data, contents.sensor);
  add_laboratory(data, contents.laboratory);
  add_persons(data, persons_of(contents));
  add_contact(data.add("dcc:customer"), contents.customer);
  add_statements(data, contents);
}

} // namespace dyncal::inline views
