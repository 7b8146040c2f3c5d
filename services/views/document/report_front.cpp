#include "services/views/document/report_sections.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/views/conformity/stated_conformity.hpp"
#include "services/views/document/html.hpp"
#include "services/views/objections/subject_objections.hpp"
#include "services/views/report/daily_check.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

std::vector<std::string> address_lines(const Contact& contact) {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& a, const std::string& b) {
    const std::string line = a.empty() || b.empty() ? a + b : a + " " + b;
    if (!line.empty()) {
      lines.push_back(line);
    }
  };
  add(contact.street, contact.street_number);
  add(contact.country + (contact.post_code.empty() ? "" : "-" + contact.post_code), contact.city);
  add(contact.email, "");
  add(contact.phone, "");
  add(contact.web, "");
  return lines;
}

std::string address_html(const std::vector<std::string>& lines) {
  std::string html;
  for (const std::string& line : lines) {
    html += escaped(line) + "<br>";
  }
  return html;
}

std::string joined_texts(const std::vector<std::string>& texts) {
  std::vector<std::string> filled;
  std::ranges::copy_if(texts, std::back_inserter(filled),
                       [](const std::string& text) { return !text.empty(); });
  return fmt::format("{}", fmt::join(filled, ", "));
}

// As the source of the channel under calibration described itself.
std::string described_sensor(const ReportContents& contents) {
  const auto source = described_source(contents.result, contents.channels.front());
  return source ? joined_texts(
                      {source->device, source->serial.empty() ? "" : "serial " + source->serial})
                : "";
}

std::string sensor_text(const ReportContents& contents) {
  if (!contents.sensor) {
    return described_sensor(contents);
  }
  const SensorFile& sensor = *contents.sensor;
  return joined_texts({sensor.name, sensor.manufacturer, sensor.model, "serial " + sensor.serial,
                       sensor.firmware.empty() ? "" : "firmware " + sensor.firmware,
                       sensor.owner_identification});
}

std::string customer_text(const ReportContents& contents) {
  const Contact* customer = nullptr;
  if (contents.sensor && contents.sensor->customer) {
    customer = &*contents.sensor->customer;
  } else if (contents.laboratory && contents.laboratory->customer) {
    customer = &*contents.laboratory->customer;
  }
  if (customer == nullptr) {
    return "";
  }
  std::vector<std::string> lines = address_lines(*customer);
  lines.insert(lines.begin(), customer->name);
  return joined_texts(lines);
}

std::string certificate_text(const CalibratedDevice& device) {
  return joined_texts({device.name, device.manufacturer, device.model,
                       device.serial.empty() ? "" : "serial " + device.serial}) +
         (device.certificate.empty()
              ? ""
              : fmt::format("; certificate {} of {}{}", device.certificate, device.issued_by,
                            device.issued.empty() ? "" : ", " + device.issued));
}

std::string reference_text(const ReportContents& contents) {
  const ReferenceStandard* reference = reference_of(contents);
  if (reference == nullptr) {
    return "";
  }
  std::string text;
  for (const CalibratedDevice& device : reference->devices) {
    text += certificate_text(device) + ". ";
  }
  return text + reference->traceability;
}

// How it came, and how it was set.
void add_state(const SensorFile& sensor, DefinitionTable& table) {
  table.add("Received", joined_texts({sensor.received, sensor.condition}));
  std::vector<std::string> settings;
  for (const auto& [name, value] : sensor.settings) {
    settings.push_back(fmt::format("{}: {}", name, value));
  }
  table.add("Settings", joined_texts(settings));
  table.add("Positive direction", sensor.positive_direction);
}

std::string place_text(const ReportContents& contents) {
  if (!contents.laboratory) {
    return "";
  }
  const LaboratoryFile& file = *contents.laboratory;
  return file.place.empty() ? joined_texts({file.laboratory.name, file.laboratory.city})
                            : file.place;
}

std::string method_text(const ReportContents& contents) {
  const std::string& method = contents.result.method;
  std::string standard = reference_of(contents) ? reference_of(contents)->standard : "";
  if (!standard.empty()) {
    standard += standard == "ISO 16063-11" ? ":1999 (by laser interferometry); "
                                           : ":2003 (by comparison to a reference transducer); ";
  }
  return standard + fmt::format("{}: {}", method, method_description(method));
}

// "2026-03-01 12:00:05 UTC"
std::string readable_instant(const std::string& utc) {
  return utc.size() < 19 ? utc : fmt::format("{} {} UTC", utc.substr(0, 10), utc.substr(11, 8));
}

std::string period(const StoredResult& result) {
  return result.began_utc.empty() ? std::string("not known: no stamps in UTC")
                                  : fmt::format("{} to {}", readable_instant(result.began_utc),
                                                readable_instant(result.ended_utc));
}

} // namespace

const ReferenceStandard* reference_of(const ReportContents& contents) {
  return reference_of(contents.result, contents.laboratory ? &*contents.laboratory : nullptr);
}

std::string title_of(const ReportContents& contents) {
  return contents.laboratory && !contents.laboratory->letterhead.title.empty()
             ? contents.laboratory->letterhead.title
             : "Calibration report";
}

std::string mark_of(const ReportContents& contents) {
  return contents.number.empty() ? "run " + contents.result.run : "No. " + contents.number;
}

std::string issuer_of(const ReportContents& contents) {
  return contents.laboratory ? contents.laboratory->laboratory.name
                             : "bench " + contents.result.bench;
}

std::string letterhead(const ReportContents& contents) {
  std::string html = "<header>\n<div class=\"issuer\">\n";
  if (contents.laboratory) {
    const LaboratoryFile& file = *contents.laboratory;
    if (file.logo) {
      html +=
          fmt::format("<img class=\"logo\" src=\"{}\" alt=\"\">\n", escaped(file.logo->data_uri()));
    }
    html += element("p", file.laboratory.name, "name");
    std::vector<std::string> lines = file.letterhead.lines;
    const std::vector<std::string> address = address_lines(file.laboratory);
    lines.insert(lines.end(), address.begin(), address.end());
    if (!file.accreditation.empty()) {
      lines.push_back("Accreditation " + file.accreditation);
    }
    html += "<p class=\"address\">" + address_html(lines) + "</p>\n";
  }
  html += "</div>\n<div class=\"title\">\n" + element("h1", title_of(contents));
  std::vector<std::string> lines;
  if (!contents.number.empty()) {
    lines.push_back("No. " + contents.number);
  }
  if (!contents.replaces.empty()) {
    lines.push_back("Replaces no. " + contents.replaces);
  }
  lines.push_back("Run " + contents.result.run);
  lines.push_back((contents.is_draft ? "Draft of " : "Issued ") + contents.issued);
  return html + "<p class=\"address\">" + address_html(lines) + "</p>\n</div>\n</header>\n";
}

std::string warnings(const ReportContents& contents) {
  const StoredResult& result = contents.result;
  std::string html;
  if (!contents.objections.empty()) {
    html += element("p", "THIS REPORT WAS FORCED: the software that evaluated the measurement "
                         "refused it. The laboratory has issued it all the same. What spoke "
                         "against it:");
  }
  for (const std::string& objection : contents.objections) {
    html += element("p", objection);
  }
  if (result.interrupted) {
    html += element("p", "The run was interrupted: not every planned step was measured.");
  }
  if (!result.problem.empty()) {
    html += element("p", "The run ended early: " + result.problem);
  }
  for (const std::string& open : result.open_closures(contents.channels)) {
    html += element("p", "What must hold over the run does not: " + open);
  }
  const auto invalid = std::ranges::count_if(result.points, [&](const StoredPoint& point) {
    return !point.valid &&
           std::ranges::find(contents.channels, point.channel) != contents.channels.end();
  });
  if (invalid > 0) {
    html += element("p", fmt::format("{} single results have no value; the reasons stand below "
                                     "the tables.",
                                     invalid));
  }
  if (!result.flags.empty()) {
    html += element(
        "p",
        fmt::format("Some values have flags (F1{}), which are explained below.",
                    result.flags.size() > 1 ? fmt::format(" to F{}", result.flags.size()) : ""));
  }
  return html.empty() ? "" : "<aside>\n" + html + "</aside>\n";
}

std::string summary(const ReportContents& contents) {
  const StoredResult& result = contents.result;
  DefinitionTable table;
  table.add("Object", sensor_text(contents));
  if (contents.sensor) {
    add_state(*contents.sensor, table);
  }
  table.add("Channels", fmt::format("{}", fmt::join(contents.channels, ", ")));
  table.add("Customer", customer_text(contents));
  table.add("Measured", period(result));
  table.add("Place", place_text(contents));
  table.add("Bench, run", fmt::format("{}, {}", result.bench, result.run));
  table.add("Excitation", fmt::format("sinusoidal, {}; {} steps planned",
                                      frequency_range(result.values_of(contents.channels.front())),
                                      result.planned_steps));
  table.add("Method", method_text(contents));
  table.add("Reference", reference_text(contents));
  table.add("Check", result.check ? sentence_of(*result.check) : "");
  table.add("Conformity", contents.conformity ? verdict_text(*contents.conformity) : "");
  table.add("Phase", sign_convention());
  table.add("Uncertainty", "JCGM 100:2008 (GUM). " + rounding_rule());
  return "<h2>Summary</h2>\n" + table.finish() +
         element("p", "The results relate only to the items calibrated, as they were received and "
                      "in the conditions stated. What departs from the method, or is to be known "
                      "with single values, stands under Flags.");
}

std::string remarks(const ReportContents& contents) {
  if (!contents.laboratory || contents.laboratory->letterhead.remarks.empty()) {
    return "";
  }
  std::string html = "<h2>Remarks</h2>\n";
  for (const std::string& text : contents.laboratory->letterhead.remarks) {
    html += element("p", text);
  }
  return html;
}

std::string signatures(const ReportContents& contents) {
  std::vector<Person> persons;
  if (contents.laboratory) {
    persons = contents.laboratory->persons;
  }
  if (persons.empty()) {
    persons.push_back({"", "Calibrated by", false});
  }
  std::string html = "<section class=\"signatures\">\n";
  html += element(
      "p", contents.laboratory ? contents.laboratory->laboratory.city + ", " : "Date: ", "place");
  html += "<div class=\"signers\">\n";
  for (const Person& person : persons) {
    html += fmt::format("<div class=\"signer\"><div class=\"line\"></div>{}{}</div>\n",
                        element("p", person.name, "name"), element("p", person.role));
  }
  return html + "</div>\n</section>\n";
}

} // namespace dyncal::inline views
