#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/views/certificate/dcc.hpp"
#include "services/views/certificate/dcc_conformity.hpp"
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
  add_text(previous, "dcc:referral", "certificate that is replaced");
  previous.add("dcc:referralID", contents.replaces);
  previous.add("dcc:procedure", "SHA-256");
  previous.add("dcc:value", contents.replaced_sha256);
}

void add_core_data(XmlElement parent, const CertificateContents& contents) {
  XmlElement core = parent.add("dcc:coreData");
  core.add("dcc:countryCodeISO3166_1", contents.laboratory.laboratory.country);
  core.add("dcc:usedLangCodeISO639_1", "en");
  core.add("dcc:mandatoryLangCodeISO639_1", "en");
  core.add("dcc:uniqueIdentifier", contents.identifier);
  XmlElement identifications = core.add("dcc:identifications");
  if (!contents.number.empty()) {
    add_identification(identifications, "basic_certificateNumber", "calibrationLaboratory",
                       contents.number, "Certificate number");
  }
  add_identification(identifications, "", "calibrationLaboratory",
                     contents.result.bench + " / " + contents.result.run, "Bench / run");
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
  add_text(item, "dcc:name", sensor.name.empty() ? "Digital sensor" : sensor.name);
  const auto release = release_of(sensor.firmware);
  if (release) {
    XmlElement software = item.add("dcc:installedSoftwares").add("dcc:software");
    add_text(software, "dcc:name", "firmware");
    software.add("dcc:release", *release);
    software.add("dcc:type", "firmware");
    add_text(software, "dcc:description", sensor.firmware);
  }
  add_make(item, sensor.manufacturer, sensor.model);
  XmlElement identifications = item.add("dcc:identifications");
  add_identification(identifications, "basic_serialNo", "manufacturer", sensor.serial,
                     "Serial number");
  if (!release && !sensor.firmware.empty()) {
    add_identification(identifications, "", "manufacturer", sensor.firmware, "Firmware");
  }
  if (!sensor.owner_identification.empty()) {
    add_identification(identifications, "", "owner", sensor.owner_identification,
                       "Identification of the owner");
  }
}

void add_laboratory(XmlElement parent, const LaboratoryFile& file) {
  XmlElement laboratory = parent.add("dcc:calibrationLaboratory");
  add_line(laboratory, "dcc:calibrationLaboratoryCode", file.accreditation);
  add_contact(laboratory.add("dcc:contact"), file.laboratory);
}

void add_persons(XmlElement parent, const LaboratoryFile& file) {
  XmlElement list = parent.add("dcc:respPersons");
  for (const Person& person : file.persons) {
    XmlElement one = list.add("dcc:respPerson");
    add_text(one.add("dcc:person"), "dcc:name", person.name);
    add_line(one, "dcc:role", person.role);
    if (person.main_signer) {
      one.add("dcc:mainSigner", "true");
    }
  }
}

void add_forced(XmlElement list, const std::vector<std::string>& objections) {
  XmlElement statement = list.add("dcc:statement").attribute("refType", "dyncal_forced");
  add_text(statement, "dcc:name", "Issued in spite of objections");
  XmlElement declaration = statement.add("dcc:declaration");
  declaration
      .add("dcc:content",
           "THIS CERTIFICATE WAS FORCED: the software that evaluated the measurement refused it. "
           "The laboratory has issued it all the same. What spoke against it:")
      .attribute("lang", "en");
  for (const std::string& objection : objections) {
    declaration.add("dcc:content", objection).attribute("lang", "en");
  }
  statement.add("dcc:valid", "false");
}

void add_traceability(XmlElement list, const ReferenceStandard& reference) {
  const CalibratedDevice& device = reference.devices.front();
  XmlElement statement = list.add("dcc:statement").attribute("refType", "basic_traceability");
  add_text(statement, "dcc:name", "Metrological traceability");
  statement.add("dcc:traceable", "true");
  statement.add("dcc:reference", single_line(device.certificate));
  add_text(statement, "dcc:declaration",
           fmt::format("{} The reference ({}, serial number {}) was calibrated by {}, certificate "
                       "{}{}.",
                       reference.traceability, device.name, device.serial, device.issued_by,
                       device.certificate, device.issued.empty() ? "" : " of " + device.issued));
}

void add_statements(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:statements");
  if (!contents.objections.empty()) {
    add_forced(list, contents.objections);
  }
  add_traceability(list, contents.reference);
  add_text(list.add("dcc:statement").attribute("refType", "dyncal_relatesOnly"), "dcc:declaration",
           "The results relate only to the items calibrated, as they were received and in the "
           "conditions stated.");
  add_conformity_statements(list, contents.conformity);
  if (const auto& check = contents.result.check) {
    add_text(list.add("dcc:statement").attribute("refType", "dyncal_dailyCheck"), "dcc:declaration",
             sentence_of(*check));
  }
  for (const std::string& text : contents.provenance) {
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
  add_software(software, contents.software, "made this certificate");
  add_core_data(data, contents);
  add_item(data, contents.sensor);
  add_laboratory(data, contents.laboratory);
  add_persons(data, contents.laboratory);
  add_contact(data.add("dcc:customer"), contents.customer);
  add_statements(data, contents);
}

} // namespace dyncal::inline views
