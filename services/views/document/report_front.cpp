#include "services/views/document/report_sections.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/views/conformity/stated_conformity.hpp"
#include "services/views/document/html.hpp"
#include "services/views/lab_file/documented_conditions.hpp"
#include "services/views/language/journal_sentences.hpp"
#include "services/views/language/reason_text.hpp"
#include "services/views/language/report_sentences.hpp"
#include "services/views/language/statement_sentences.hpp"
#include "services/views/objections/objections.hpp"
#include "services/views/objections/subject_objections.hpp"
#include "services/views/report/amendments.hpp"
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
                      {source->device, source->serial.empty()
                                           ? ""
                                           : sentences::serial(contents.language, source->serial)})
                : "";
}

std::string sensor_text(const ReportContents& contents) {
  if (!contents.sensor) {
    return described_sensor(contents);
  }
  const SensorFile& sensor = *contents.sensor;
  const Language language = contents.language;
  return joined_texts(
      {sensor.name, sensor.manufacturer, sensor.model, sentences::serial(language, sensor.serial),
       sensor.firmware.empty() ? "" : sentences::firmware(language, sensor.firmware),
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
  Contact corrected = *customer;
  amend(contents.result.journal, corrected);
  std::vector<std::string> lines = address_lines(corrected);
  lines.insert(lines.begin(), corrected.name);
  return joined_texts(lines);
}

std::string certificate_text(const CalibratedDevice& device, Language language) {
  const std::string of_device =
      joined_texts({device.name, device.manufacturer, device.model,
                    device.serial.empty() ? "" : sentences::serial(language, device.serial)});
  const std::string day = device.issued.empty() ? "" : ", " + day_text(language, device.issued);
  return device.certificate.empty()
             ? of_device
             : fmt::format(
                   "{}; {}", of_device,
                   sentences::certificate_of(language, device.certificate, device.issued_by, day));
}

std::string reference_text(const ReportContents& contents) {
  const ReferenceStandard* reference = reference_of(contents);
  if (reference == nullptr) {
    return "";
  }
  std::string text;
  for (const CalibratedDevice& device : reference->devices) {
    text += certificate_text(device, contents.language) + ". ";
  }
  return text + reference->traceability;
}

// How it came, and how it was set.
void add_state(const SensorFile& sensor, Language language, DefinitionTable& table) {
  table.add(sentences::received,
            joined_texts({day_text(language, sensor.received), sensor.condition}));
  std::vector<std::string> settings;
  for (const auto& [name, value] : sensor.settings) {
    settings.push_back(fmt::format("{}: {}", name, value));
  }
  table.add(sentences::settings, joined_texts(settings));
  table.add(sentences::positive_direction, sensor.positive_direction);
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
  const Language language = contents.language;
  std::string standard = reference_of(contents) ? reference_of(contents)->standard : "";
  if (!standard.empty()) {
    standard = standard == "ISO 16063-11" ? sentences::by_interferometry(language, standard)
                                          : sentences::by_comparison(language, standard);
  }
  return standard + fmt::format("{}: {}", method, method_description(method, language));
}

std::string period(const StoredResult& result, Language language) {
  return result.began_utc.empty()
             ? sentences::measured_unknown(language)
             : sentences::measured_from(language, instant_text(language, result.began_utc),
                                        instant_text(language, result.ended_utc));
}

} // namespace

const ReferenceStandard* reference_of(const ReportContents& contents) {
  return reference_of(contents.result, contents.laboratory ? &*contents.laboratory : nullptr);
}

std::string title_of(const ReportContents& contents) {
  return contents.laboratory && !contents.laboratory->letterhead.title.empty()
             ? contents.laboratory->letterhead.title
             : sentences::calibration_report(contents.language);
}

std::string mark_of(const ReportContents& contents) {
  return contents.number.empty() ? sentences::run_mark(contents.language, contents.result.run)
                                 : sentences::number_mark(contents.language, contents.number);
}

std::string issuer_of(const ReportContents& contents) {
  return contents.laboratory ? contents.laboratory->laboratory.name
                             : sentences::bench_mark(contents.language, contents.result.bench);
}

std::string letterhead(const ReportContents& contents) {
  const Language language = contents.language;
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
      lines.push_back(sentences::accreditation(language, file.accreditation));
    }
    html += "<p class=\"address\">" + address_html(lines) + "</p>\n";
  }
  html += "</div>\n<div class=\"title\">\n" + element("h1", title_of(contents));
  std::vector<std::string> lines;
  if (!contents.number.empty()) {
    lines.push_back(sentences::number_mark(language, contents.number));
  }
  if (!contents.replaces.empty()) {
    lines.push_back(sentences::replaces_number(language, contents.replaces));
  }
  lines.push_back(sentences::run_line(language, contents.result.run));
  lines.push_back((contents.is_draft ? sentences::draft_of : sentences::issued_on)(
      language, day_text(language, contents.issued)));
  if (contents.languages.size() > 1) {
    lines.push_back(sentences::holding_language(language));
  }
  return html + "<p class=\"address\">" + address_html(lines) + "</p>\n</div>\n</header>\n";
}

std::string warnings(const ReportContents& contents) {
  const StoredResult& result = contents.result;
  const Language language = contents.language;
  std::string html;
  if (!contents.objections.empty()) {
    html += element("p", sentences::forced, language);
  }
  for (const TranslatedText& objection : contents.objections) {
    html += element("p", objection.in(language));
  }
  if (result.interrupted) {
    html += element("p", sentences::interrupted, language);
  }
  if (!result.problem.empty()) {
    html += element("p", sentences::ended_early(language, reason_text(language, result.problem)));
  }
  for (const TranslatedText& open : open_closures_of(result, contents.channels)) {
    html += element("p", sentences::does_not_hold(language, open.in(language)));
  }
  const auto invalid = std::ranges::count_if(result.points, [&](const StoredPoint& point) {
    return !point.valid &&
           std::ranges::find(contents.channels, point.channel) != contents.channels.end();
  });
  if (invalid > 0) {
    html += element("p", sentences::without_value(language, invalid));
  }
  if (const std::size_t flags = result.flags.size(); flags > 0) {
    html += element(
        "p", sentences::have_flags(language, flags > 1 ? sentences::to_flag(language, flags) : ""));
  }
  return html.empty() ? "" : "<aside>\n" + html + "</aside>\n";
}

std::string summary(const ReportContents& contents) {
  const StoredResult& result = contents.result;
  const Language language = contents.language;
  DefinitionTable table(language);
  table.add(sentences::object, sensor_text(contents));
  if (contents.sensor) {
    add_state(*contents.sensor, language, table);
  }
  table.add(sentences::channels, fmt::format("{}", fmt::join(contents.channels, ", ")));
  table.add(sentences::customer, customer_text(contents));
  table.add(sentences::measured, period(result, language));
  table.add(sentences::performed_by, result.conducted_by ? name_of(*result.conducted_by) : "");
  table.add(sentences::comment, result.comment);
  for (const std::string& sentence : amendment_sentences(result.journal, language)) {
    table.add(sentences::corrected, sentence);
  }
  table.add(sentences::place, place_text(contents));
  table.add(sentences::bench_and_run, fmt::format("{}, {}", result.bench, result.run));
  table.add(sentences::excitation,
            sentences::sinusoidal(
                language, frequency_range(result.values_of(contents.channels.front()), language),
                result.planned_steps));
  table.add(sentences::method, method_text(contents));
  table.add(sentences::reference, reference_text(contents));
  table.add(sentences::check, result.check ? sentence_of(*result.check, language) : "");
  table.add(sentences::conformity,
            contents.conformity ? verdict_text(*contents.conformity, language) : "");
  table.add(sentences::phase, sentences::sign_convention(language));
  table.add(sentences::uncertainty, "JCGM 100:2008 (GUM). " + sentences::rounding_rule(language));
  return element("h2", sentences::summary, language) + table.finish() +
         element("p", fmt::format("{} {}", sentences::relates_only.in(language),
                                  sentences::departures.in(language)));
}

std::string remarks(const ReportContents& contents) {
  if (!contents.laboratory || contents.laboratory->letterhead.remarks.empty()) {
    return "";
  }
  std::string html = element("h2", sentences::remarks, contents.language);
  for (const std::string& text : contents.laboratory->letterhead.remarks) {
    html += element("p", text);
  }
  return html;
}

std::string signatures(const ReportContents& contents) {
  const Language language = contents.language;
  std::vector<Person> persons;
  if (contents.laboratory) {
    persons = contents.laboratory->persons;
  }
  if (persons.empty()) {
    persons.push_back({"", sentences::calibrated_by(language), false});
  }
  std::string html = "<section class=\"signatures\">\n";
  html += element("p",
                  contents.laboratory ? contents.laboratory->laboratory.city + ", "
                                      : sentences::date(language),
                  "place");
  html += "<div class=\"signers\">\n";
  for (const Person& person : persons) {
    html += fmt::format("<div class=\"signer\"><div class=\"line\"></div>{}{}</div>\n",
                        element("p", person.name, "name"), element("p", person.role));
  }
  return html + "</div>\n</section>\n";
}

} // namespace dyncal::inline views
