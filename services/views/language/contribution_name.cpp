#include "services/views/language/contribution_name.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "services/base/per_enumerator.hpp"
#include "services/views/language/sentence.hpp"

namespace dyncal::inline views {
namespace {

// In the order of analysis::ContributionKind; the place is for the subject.
constexpr Sentence kinds[] = {
    {"{}, noise", "{}, Rauschen"},
    {"{}, resolution of the converter", "{}, Auflösung des Wandlers"},
    {"sensor under calibration, amplitude raised by noise",
     "Kalibriergegenstand, Erhöhung der Amplitude durch Rauschen"},
    {"{}, variation within the record", "{}, Schwankung innerhalb der Aufzeichnung"},
    {"{}, jitter", "{}, Jitter"},
    {"{}, resolution", "{}, Auflösung"},
    {"voltage, sync ADC of the acquisition unit, jitter",
     "Spannung, Sync-ADU der Erfassungseinheit, Jitter"},
    {"voltage, sync ADC of the acquisition unit, phase shift",
     "Spannung, Sync-ADU der Erfassungseinheit, Phasenverschiebung"},
    {"delay between {}", "Laufzeitunterschied {}"},
    {"reference transducer, {}", "Bezugsnormal, {}"},
    {"frequency of the excitation, between the records",
     "Frequenz der Anregung, zwischen den Aufzeichnungen"},
    {"time stamps, offset between the clocks", "Zeitstempel, Versatz der Uhren"},
    {"sample rate of the sensor, to the first sample of the series",
     "Abtastrate des Kalibriergegenstands, bis zum ersten Wert der Serie"},
    {"trigger of the oscilloscope, delay", "Trigger des Oszilloskops, Laufzeit"},
    {"start of the series after the trigger", "Beginn der Serie nach dem Trigger"},
    {"repeatability of series and trigger", "Wiederholpräzision von Serien und Trigger"},
    {"time base of the oscilloscope", "Zeitbasis des Oszilloskops"},
    {"{}, hum", "{}, Netzbrummen"},
    {"{}, distortion (harmonics folded by sampling)",
     "{}, Klirren (durch Abtastung gefaltete Oberschwingungen)"},
    {"{}, background vibration and interference", "{}, Störschwingungen und Störsignale"},
    {"transverse motion of the exciter", "Querbewegung des Schwingungserregers"},
    {"frequency of the excitation, between displacement, velocity and acceleration",
     "Frequenz der Anregung, zwischen Weg, Geschwindigkeit und Beschleunigung"},
    {"interferometer, ellipse of the quadrature signals",
     "Interferometer, Ellipse der Quadratursignale"},
    {"interferometer, residual periodic error", "Interferometer, periodische Restabweichung"},
    {"interferometer, wavelength in air", "Interferometer, Wellenlänge in Luft"},
    {"interferometer, bandwidth of the detectors", "Interferometer, Bandbreite der Detektoren"},
    {"interferometer, skew of the detectors", "Interferometer, Laufzeitunterschied der Detektoren"},
    {"reference evaluated over another time than the sensor",
     "Bezugswert über eine andere Zeit ausgewertet als der Kalibriergegenstand"},
    {"{}", "{}"},
};
static_assert(std::size(kinds) == static_cast<std::size_t>(analysis::ContributionKind::other) + 1);

constexpr Sentence sensitivity{"sensitivity", "Übertragungskoeffizient"};

// Subjects that evaluation gives its rows.
constexpr std::pair<std::string_view, Sentence> subjects[] = {
    {"the sensor", {"sensor under calibration", "Kalibriergegenstand"}},
    {"the sensor, where every second value differs",
     {"sensor under calibration, difference of every second value",
      "Kalibriergegenstand, Unterschied jedes zweiten Werts"}},
    {"the reference", {"reference transducer", "Bezugsnormal"}},
    {"the ACS sync",
     {"voltage, sync ADC of the reference system", "Spannung, Sync-ADU des Referenzsystems"}},
    {"the DAU sync",
     {"voltage, sync ADC of the acquisition unit", "Spannung, Sync-ADU der Erfassungseinheit"}},
    {"the DAU stamps",
     {"time stamps of the acquisition unit", "Zeitstempel der Erfassungseinheit"}},
    {"the DAU stamps, in step with the signal",
     {"time stamps of the acquisition unit, in step with the signal",
      "Zeitstempel der Erfassungseinheit, im Takt des Signals"}},
    {"the DAU stamps, on average",
     {"time stamps of the acquisition unit, on average",
      "Zeitstempel der Erfassungseinheit, im Mittel"}},
    {"the sensor's stamps, in step with the signal",
     {"time stamps of the sensor, in step with the signal",
      "Zeitstempel des Kalibriergegenstands, im Takt des Signals"}},
    {"the sensor's stamps, on average",
     {"time stamps of the sensor, on average", "Zeitstempel des Kalibriergegenstands, im Mittel"}},
    {"the stamps", {"time stamps", "Zeitstempel"}},
    {"the stamps of the sensor, as corrected",
     {"time stamps of the sensor, correction", "Zeitstempel des Kalibriergegenstands, Korrektion"}},
    {"the stamps of the reference, as corrected",
     {"time stamps of the reference, correction", "Zeitstempel des Bezugsnormals, Korrektion"}},
    {"the stamps of the ACS sync, as corrected",
     {"time stamps of the reference system, correction",
      "Zeitstempel des Referenzsystems, Korrektion"}},
    {"the stamps of the DAU sync, as corrected",
     {"time stamps of the acquisition unit, correction",
      "Zeitstempel der Erfassungseinheit, Korrektion"}},
    {"response of the channel", {"response of the channel", "Frequenzgang des Kanals"}},
    {"response of the channel, interpolation",
     {"response of the channel, interpolation", "Frequenzgang des Kanals, Interpolation"}},
    {"the channels",
     {"the channels of the measuring system", "zwischen den Kanälen des Messsystems"}},
    {"the ACS channels",
     {"the channels of the reference system", "zwischen den Kanälen des Referenzsystems"}},
    {"the oscilloscope's trace", {"trace of the oscilloscope", "Aufzeichnung des Oszilloskops"}},
    {"the series", {"series of the sensor", "Serien des Kalibriergegenstands"}},
    {"the ratio of the signals",
     {"ratio of sensor and reference", "Verhältnis von Kalibriergegenstand und Bezugsnormal"}},
    {"the lines beside the excitation",
     {"frequencies beside the excitation", "Frequenzen neben der Anregung"}},
    {"the exciter, where the clocks see other parts of it",
     {"exciter, in the parts that one record alone has",
      "Schwingungserreger, in Teilen nur einer Aufzeichnung"}},
    {"repetitions of one mounting",
     {"repetitions of one mounting", "Wiederholungen einer Montage"}},
    {"mountings", {"mountings", "Montagen"}},
};

std::string subject_name(const std::string& subject, Language language) {
  const auto* const known =
      std::ranges::find(subjects, subject, &std::pair<std::string_view, Sentence>::first);
  return known == std::end(subjects) ? subject : std::string(known->second.in(language));
}

} // namespace

std::string contribution_name(const analysis::Contribution& row, Language language) {
  const bool is_whole_reference =
      row.kind == analysis::ContributionKind::reference && row.subject.empty();
  return kinds[static_cast<std::size_t>(row.kind)](
      language, is_whole_reference ? std::string(sensitivity.in(language))
                                   : subject_name(row.subject, language));
}

std::string_view name_of(analysis::Distribution distribution, Language language) {
  static constexpr Sentence names[] = {{"normal", "normal"},
                                       {"rectangular", "rechteckig"},
                                       {"triangular", "dreieckig"},
                                       {"arcsine", "U-förmig"}};
  return per_enumerator(distribution, names).in(language);
}

std::string_view name_of(analysis::Repeats repeats, Language language) {
  static constexpr Sentence names[] = {{"drawn in each", "in jeder neu"},
                                       {"the same in all", "in allen gleich"},
                                       {"the same delay in all", "in allen dieselbe Laufzeit"}};
  return per_enumerator(repeats, names).in(language);
}

} // namespace dyncal::inline views
