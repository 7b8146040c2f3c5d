#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/base/rounding.hpp"
#include "services/views/certificate/dcc.hpp"
#include "services/views/certificate/dcc_conformity.hpp"
#include "services/views/lab_file/embedded_picture.hpp"
#include "services/views/language/certificate_sentences.hpp"
#include "services/views/language/journal_sentences.hpp"
#include "services/views/language/setup_sentences.hpp"
#include "services/views/language/statement_sentences.hpp"
#include "services/views/report/run_equipment.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

constexpr double kelvin_at_0_degc = 273.15;
constexpr double pascal_per_hpa = 100.0;

XmlElement add_method(XmlElement list, std::string_view type, const Sentence& name,
                      const TranslatedText& description, const std::vector<std::string>& norms) {
  XmlElement method = list.add("dcc:usedMethod");
  method.attribute("refType", type);
  add_text(method, "dcc:name", name);
  add_text(method, "dcc:description", description);
  for (const std::string& norm : norms) {
    method.add("dcc:norm", norm);
  }
  return method;
}

void add_methods(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:usedMethods");
  const bool is_primary = contents.reference.standard == "ISO 16063-11";
  add_method(list,
             is_primary ? "vibration_primarySineCalibration" : "vibration_secondarySineCalibration",
             is_primary ? sentences::primary_method : sentences::secondary_method,
             in_all_languages([&](Language language) {
               return method_description(contents.result.method, language);
             }),
             {is_primary ? "ISO 16063-11:1999" : "ISO 16063-21:2003"});
  const TranslatedText uncertainty = in_all_languages([&](Language language) {
    const std::string text =
        sentences::stated_uncertainties(language, sentences::rounding_rule.in(language));
    return contents.has_monte_carlo ? text + sentences::monte_carlo(language) : text;
  });
  std::vector<std::string> norms{"JCGM 100:2008"};
  if (contents.has_monte_carlo) {
    norms.emplace_back("JCGM 101:2008");
  }
  add_method(list, "basic_methodMeasurementUncertainty", sentences::measurement_uncertainty,
             uncertainty, norms);
  add_method(list, "dyncal_phaseConvention", sentences::phase_convention,
             sentences::sign_convention.translated(), {"ISO 2041:2018"});
}

void add_used_software(XmlElement parent, const StoredResult& result) {
  XmlElement list = parent.add("dcc:usedSoftware");
  add_software(list, result.software, sentences::conducted_run);
  if (!result.analysis_software.empty()) {
    add_software(list, result.analysis_software, sentences::evaluated_run);
  }
}

XmlElement add_equipment(XmlElement list, const TranslatedText& name,
                         const CalibratedDevice& equipment, const TranslatedText& description) {
  XmlElement one = list.add("dcc:measuringEquipment");
  add_text(one, "dcc:name", name);
  if (!description.empty()) {
    add_text(one, "dcc:description", description);
  }
  add_make(one, equipment.manufacturer, equipment.model);
  if (!equipment.serial.empty()) {
    add_identification(one.add("dcc:identifications"), "basic_serialNo", "manufacturer",
                       equipment.serial, sentences::serial_number);
  }
  return one;
}

XmlElement add_equipment(XmlElement list, const CalibratedDevice& equipment,
                         const TranslatedText& description) {
  return add_equipment(list, {equipment.name, equipment.name}, equipment, description);
}

std::string certificate_of(const CalibratedDevice& device, Language language) {
  return device.certificate.empty()
             ? ""
             : sentences::device_certificate(
                   language, device.certificate, device.issued_by,
                   device.issued.empty() ? "" : ", " + day_text(language, device.issued));
}

void add_run_equipment(XmlElement list, const CertificateContents& contents) {
  const std::string& channel = contents.channels.front().channel;
  const auto english = run_equipment(contents.result, channel, Language::english);
  const auto german = run_equipment(contents.result, channel, Language::german);
  for (std::size_t i = 0; i < english.size(); ++i) {
    const CalibratedDevice& device = english[i];
    add_equipment(
        list, {device.name, german[i].name}, device,
        device.certificate.empty() ? TranslatedText() : in_all_languages([&](Language language) {
          return sentences::calibrated_by_file(language, device.certificate);
        }));
  }
}

void add_equipments(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:measuringEquipments");
  std::string traceability = contents.reference.traceability + " ";
  for (const CalibratedDevice& device : contents.reference.devices) {
    add_equipment(list, device, in_all_languages([&](Language language) {
                    return sentences::reference_device(language, traceability,
                                                       certificate_of(device, language));
                  }))
        .attribute("refType", "basic_referenceStandard");
    traceability.clear();
  }
  for (const CalibratedDevice& equipment : contents.laboratory.equipment) {
    add_equipment(list, equipment, in_all_languages([&](Language language) {
                    return certificate_of(equipment, language);
                  }));
  }
  add_run_equipment(list, contents);
}

void add_real(XmlElement parent, double value, double expanded, std::string_view unit) {
  const RoundedValue rounded = round_by_uncertainty(value, expanded);
  XmlElement real = parent.add("si:real");
  real.add("si:value", rounded.value);
  real.add("si:unit", unit);
  XmlElement uncertainty = real.add("si:measurementUncertaintyUnivariate").add("si:expandedMU");
  uncertainty.add("si:valueExpandedMU", rounded.u);
  uncertainty.add("si:coverageFactor", "2.00");
  uncertainty.add("si:coverageProbability", "0.95");
}

XmlElement add_condition(XmlElement list, const TranslatedText& name) {
  XmlElement condition = list.add("dcc:influenceCondition");
  add_text(condition, "dcc:name", name);
  return condition.add("dcc:data");
}

void add_stated_conditions(XmlElement list, const Conditions& conditions) {
  if (const auto& temperature = conditions.temperature_degc) {
    XmlElement quantity =
        add_condition(list, sentences::ambient_temperature.translated()).add("dcc:quantity");
    XmlElement hybrid = quantity.attribute("refType", "basic_temperature").add("si:hybrid");
    add_real(hybrid, temperature->value + kelvin_at_0_degc, temperature->expanded, "\\kelvin");
    add_real(hybrid, temperature->value, temperature->expanded, "\\degreecelsius");
  }
  if (const auto& humidity = conditions.humidity_percent) {
    XmlElement quantity =
        add_condition(list, sentences::relative_humidity.translated()).add("dcc:quantity");
    add_real(quantity.attribute("refType", "basic_humidityRelative"), humidity->value,
             humidity->expanded, "\\percent");
  }
  if (const auto& pressure = conditions.pressure_hpa) {
    XmlElement quantity =
        add_condition(list, sentences::air_pressure.translated()).add("dcc:quantity");
    add_real(quantity.attribute("refType", "basic_pressureAtmospheric"),
             pascal_per_hpa * pressure->value, pascal_per_hpa * pressure->expanded, "\\pascal");
  }
}

void add_conditions(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:influenceConditions");
  add_stated_conditions(list, contents.conditions);
  const auto add_said = [&](const TranslatedText& name, const TranslatedText& text) {
    if (!text.empty()) {
      add_text(add_condition(list, name), "dcc:text", text);
    }
  };
  const auto add_own = [&](const Sentence& name, const std::string& text) {
    add_said(name.translated(), {text, text});
  };
  for (const auto& [name, value] : contents.sensor.settings) {
    const std::string& setting = name;
    add_said(in_all_languages(
                 [&](Language language) { return sentences::sensor_setting(language, setting); }),
             {value, value});
  }
  add_own(sentences::positive_direction_of_axis, contents.sensor.positive_direction);
  add_own(sentences::mounting, contents.conditions.mounting);
  add_own(sentences::orientation, contents.conditions.orientation);
  for (const TranslatedText& origin : contents.condition_origins) {
    add_said(sentences::origin_of_conditions.translated(), origin);
  }
  std::vector<std::string> channels;
  for (const CertifiedChannel& channel : contents.channels) {
    channels.push_back(channel.channel);
  }
  const std::vector<StoredPoint> points = contents.result.points_of(channels);
  add_own(sentences::excited_axis, points.empty() ? "" : points.front().excited_axis);
  add_said(sentences::sensor_temperature.translated(), in_all_languages([&](Language language) {
             const std::string range = temperature_range(points, language);
             return range.empty() ? "" : sentences::temperature_by_itself(language, range);
           }));
  add_said(sentences::excitation_level.translated(), in_all_languages([&](Language language) {
             const std::string range = level_range(points, language);
             return range.empty() ? sentences::level_as_planned(language)
                                  : sentences::level_of_reference(language, range);
           }));
}

XmlElement add_meta_data(XmlElement list, std::string_view type, const Sentence& name) {
  XmlElement data = list.add("dcc:metaData").attribute("refType", type);
  add_text(data, "dcc:name", name);
  return data;
}

void add_said(XmlElement list, std::string_view type, const Sentence& name,
              const TranslatedText& text) {
  if (!text.empty()) {
    add_text(add_meta_data(list, type, name), "dcc:declaration", text);
  }
}

void add_hash(XmlElement list, std::string_view type, const Sentence& name,
              const std::string& sha256) {
  add_said(list, type, name, {sha256, sha256});
}

std::string clock_text(const ClockReport& report, Language language) {
  const double rate_hz = report.clock.mean_rate_hz;
  const double u_interval_s = report.clock.u_mean_interval_s;
  if (std::isfinite(u_interval_s) && u_interval_s > 0.0 && report.clock.mean_interval_s > 0.0) {
    return sentences::clock_rate(language, report.source,
                                 stated_text(rate_hz, report.clock.of_mean_rate(), "Hz", language));
  }
  return sentences::clock_rate_for_information(language, report.source,
                                               decimal(language, fmt::format("{:.6g}", rate_hz)));
}

void add_clock(XmlElement list, const StoredResult& result) {
  for (const ClockReport& clock : result.clocks) {
    add_said(list, "dyncal_sampleClock", sentences::sample_clock,
             in_all_languages([&](Language language) { return clock_text(clock, language); }));
  }
}

void add_recipe(XmlElement list, const StoredResult& result) {
  if (result.recipe.empty()) {
    return;
  }
  XmlElement data = add_meta_data(list, "dyncal_recipe", sentences::recipe_file);
  XmlElement file = data.add("dcc:data").add("dcc:byteData");
  file.add("dcc:fileName", "bench.toml");
  file.add("dcc:mimeType", "application/toml");
  file.add("dcc:dataBase64", base64(result.recipe));
}

void add_all_meta_data(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:measurementMetaData");
  add_hash(list, "dyncal_resultSha256", sentences::result_hash, contents.result.sha256);
  add_hash(list, "dyncal_recipeSha256", sentences::hash_of_recipe, contents.result.recipe_sha256);
  add_hash(list, "dyncal_recordingSha256", sentences::recording_hash, contents.recording_sha256);
  if (const auto& person = contents.result.conducted_by) {
    add_said(list, "dyncal_performedBy", sentences::measurement_performed_by,
             {name_of(*person), name_of(*person)});
  }
  add_said(list, "dyncal_comment", sentences::comment_on_run,
           {contents.result.comment, contents.result.comment});
  add_conformity(list, contents.conformity);
  add_clock(list, contents.result);
  for (const TranslatedText& flag : contents.flags) {
    add_said(list, "dyncal_flag", sentences::known_with_values, flag);
  }
  if (contents.objections.empty()) {
    add_said(list, "dyncal_losses", sentences::losses_name, sentences::no_losses.translated());
  }
  add_recipe(list, contents.result);
}

} // namespace

void add_measurement_results(XmlElement root, const CertificateContents& contents) {
  XmlElement result = root.add("dcc:measurementResults").add("dcc:measurementResult");
  add_text(result, "dcc:name", sentences::measurement);
  add_methods(result, contents);
  add_used_software(result, contents.result);
  add_equipments(result, contents);
  add_conditions(result, contents);
  add_results(result, contents.channels, !contents.objections.empty());
  add_all_meta_data(result, contents);
}

} // namespace dyncal::inline views
