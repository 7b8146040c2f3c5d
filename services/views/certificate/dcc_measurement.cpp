#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/base/rounding.hpp"
#include "services/views/certificate/dcc.hpp"
#include "services/views/certificate/dcc_conformity.hpp"
#include "services/views/lab_file/embedded_picture.hpp"
#include "services/views/report/run_equipment.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

constexpr double kelvin_at_0_degc = 273.15;
constexpr double pascal_per_hpa = 100.0;

XmlElement add_method(XmlElement list, std::string_view type, std::string_view name,
                      const std::string& description, const std::vector<std::string>& norms) {
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
             is_primary ? "Calibration by laser interferometry with sinusoidal excitation"
                        : "Calibration by comparison to a reference transducer with sinusoidal "
                          "excitation",
             method_description(contents.result.method),
             {is_primary ? "ISO 16063-11:1999" : "ISO 16063-21:2003"});
  std::string uncertainty =
      "Expanded uncertainties U = k u with the coverage factor k stated with each value, for the "
      "coverage probability stated with it; u from the contributions by the law of propagation. " +
      rounding_rule();
  std::vector<std::string> norms{"JCGM 100:2008"};
  if (contents.has_monte_carlo) {
    uncertainty += " Every single result was cross-checked by the Monte Carlo method.";
    norms.emplace_back("JCGM 101:2008");
  }
  add_method(list, "basic_methodMeasurementUncertainty", "Measurement uncertainty", uncertainty,
             norms);
  add_method(list, "dyncal_phaseConvention", "Sign convention of the phase", sign_convention(),
             {"ISO 2041:2018"});
}

void add_used_software(XmlElement parent, const StoredResult& result) {
  XmlElement list = parent.add("dcc:usedSoftware");
  add_software(list, result.software, "conducted the run");
  if (!result.analysis_software.empty()) {
    add_software(list, result.analysis_software, "evaluated the run");
  }
}

XmlElement add_equipment(XmlElement list, const CalibratedDevice& equipment,
                         const std::string& description) {
  XmlElement one = list.add("dcc:measuringEquipment");
  add_text(one, "dcc:name", equipment.name);
  if (!description.empty()) {
    add_text(one, "dcc:description", description);
  }
  add_make(one, equipment.manufacturer, equipment.model);
  if (!equipment.serial.empty()) {
    add_identification(one.add("dcc:identifications"), "basic_serialNo", "manufacturer",
                       equipment.serial, "Serial number");
  }
  return one;
}

std::string certificate_of(const CalibratedDevice& device) {
  return device.certificate.empty()
             ? ""
             : fmt::format("Certificate {} of {}{}.", device.certificate, device.issued_by,
                           device.issued.empty() ? "" : ", " + device.issued);
}

void add_equipments(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:measuringEquipments");
  std::string traceability = contents.reference.traceability + " ";
  for (const CalibratedDevice& device : contents.reference.devices) {
    add_equipment(list, device,
                  fmt::format("Reference. {}{}", traceability, certificate_of(device)))
        .attribute("refType", "basic_referenceStandard");
    traceability.clear();
  }
  for (const CalibratedDevice& equipment : contents.laboratory.equipment) {
    add_equipment(list, equipment, certificate_of(equipment));
  }
  for (const CalibratedDevice& device :
       run_equipment(contents.result, contents.channels.front().channel)) {
    add_equipment(list, device,
                  device.certificate.empty() ? "" : "Calibrated by " + device.certificate);
  }
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

XmlElement add_condition(XmlElement list, std::string_view name) {
  XmlElement condition = list.add("dcc:influenceCondition");
  add_text(condition, "dcc:name", name);
  return condition.add("dcc:data");
}

void add_stated_conditions(XmlElement list, const Conditions& conditions) {
  if (const auto& temperature = conditions.temperature_degc) {
    XmlElement quantity = add_condition(list, "Ambient temperature").add("dcc:quantity");
    XmlElement hybrid = quantity.attribute("refType", "basic_temperature").add("si:hybrid");
    add_real(hybrid, temperature->value + kelvin_at_0_degc, temperature->expanded, "\\kelvin");
    add_real(hybrid, temperature->value, temperature->expanded, "\\degreecelsius");
  }
  if (const auto& humidity = conditions.humidity_percent) {
    XmlElement quantity = add_condition(list, "Relative humidity").add("dcc:quantity");
    add_real(quantity.attribute("refType", "basic_humidityRelative"), humidity->value,
             humidity->expanded, "\\percent");
  }
  if (const auto& pressure = conditions.pressure_hpa) {
    XmlElement quantity = add_condition(list, "Air pressure").add("dcc:quantity");
    add_real(quantity.attribute("refType", "basic_pressureAtmospheric"),
             pascal_per_hpa * pressure->value, pascal_per_hpa * pressure->expanded, "\\pascal");
  }
}

void add_conditions(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:influenceConditions");
  add_stated_conditions(list, contents.conditions);
  const auto add_said = [&](std::string_view name, const std::string& text) {
    if (!text.empty()) {
      add_text(add_condition(list, name), "dcc:text", text);
    }
  };
  for (const auto& [name, value] : contents.sensor.settings) {
    add_said("Setting of the sensor: " + name, value);
  }
  add_said("Positive direction of the axis", contents.sensor.positive_direction);
  add_said("Mounting", contents.conditions.mounting);
  add_said("Orientation", contents.conditions.orientation);
  std::vector<std::string> channels;
  for (const CertifiedChannel& channel : contents.channels) {
    channels.push_back(channel.channel);
  }
  const std::vector<StoredPoint> points = contents.result.points_of(channels);
  add_said("Excited axis", points.empty() ? "" : points.front().excited_axis);
  const std::string temperature = temperature_range(points);
  add_said("Temperature of the sensor",
           temperature.empty() ? ""
                               : temperature + " degrees Celsius, measured by the sensor itself, "
                                               "for information");
  const std::string level = level_range(points);
  add_said("Level of the excitation",
           level.empty()
               ? "sinusoidal, amplitude as planned"
               : fmt::format("sinusoidal, amplitude from the reference: {} m/s^2", level));
}

XmlElement add_meta_data(XmlElement list, std::string_view type, std::string_view name) {
  XmlElement data = list.add("dcc:metaData").attribute("refType", type);
  add_text(data, "dcc:name", name);
  return data;
}

void add_said(XmlElement list, std::string_view type, std::string_view name,
              const std::string& text) {
  if (!text.empty()) {
    add_text(add_meta_data(list, type, name), "dcc:declaration", text);
  }
}

std::string clock_text(const ClockReport& report) {
  const double rate_hz = report.clock.mean_rate_hz;
  const double u_interval_s = report.clock.u_mean_interval_s;
  const std::string head = fmt::format("Source '{}': ", report.source);
  if (std::isfinite(u_interval_s) && u_interval_s > 0.0 && report.clock.mean_interval_s > 0.0) {
    return fmt::format("{}mean sample rate {}.", head,
                       stated_text(rate_hz, report.clock.of_mean_rate(), "Hz"));
  }
  return fmt::format("{}mean sample rate {:.6g} Hz, for information: nothing is known of the "
                     "uncertainty of the clock that it was compared with.",
                     head, rate_hz);
}

void add_clock(XmlElement list, const StoredResult& result) {
  for (const ClockReport& clock : result.clocks) {
    add_said(list, "dyncal_sampleClock", "Sample clock", clock_text(clock));
  }
}

void add_recipe(XmlElement list, const StoredResult& result) {
  if (result.recipe.empty()) {
    return;
  }
  XmlElement data = add_meta_data(list, "dyncal_recipe", "Recipe: the bench file of the run");
  XmlElement file = data.add("dcc:data").add("dcc:byteData");
  file.add("dcc:fileName", "bench.toml");
  file.add("dcc:mimeType", "application/toml");
  file.add("dcc:dataBase64", base64(result.recipe));
}

void add_all_meta_data(XmlElement parent, const CertificateContents& contents) {
  XmlElement list = parent.add("dcc:measurementMetaData");
  add_said(list, "dyncal_resultSha256", "SHA-256 of the result file", contents.result.sha256);
  add_said(list, "dyncal_recipeSha256", "SHA-256 of the recipe", contents.result.recipe_sha256);
  add_said(list, "dyncal_recordingSha256", "SHA-256 of the recording", contents.recording_sha256);
  add_conformity(list, contents.conformity);
  add_clock(list, contents.result);
  for (const std::string& flag : contents.flags) {
    add_said(list, "dyncal_flag", "To be known with the values", flag);
  }
  if (contents.objections.empty()) {
    add_said(list, "dyncal_losses", "Losses",
             "No value stated here lacks samples for a reason that is not stated with it.");
  }
  add_recipe(list, contents.result);
}

} // namespace

void add_measurement_results(XmlElement root, const CertificateContents& contents) {
  XmlElement result = root.add("dcc:measurementResults").add("dcc:measurementResult");
  add_text(result, "dcc:name", "Dynamic calibration with sinusoidal excitation");
  add_methods(result, contents);
  add_used_software(result, contents.result);
  add_equipments(result, contents);
  add_conditions(result, contents);
  add_results(result, contents.channels, !contents.objections.empty());
  add_all_meta_data(result, contents);
}

} // namespace dyncal::inline views
