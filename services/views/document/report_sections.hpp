// What a report is made of: the stored result, what laboratory and sensor files add to it, and the
// parts that become of them, in a file for each subject. HTML; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/views/conformity/conformity.hpp"
#include "services/views/lab_file/embedded_picture.hpp"
#include "services/views/lab_file/laboratory_file.hpp"
#include "services/views/lab_file/sensor_file.hpp"
#include "services/views/language/sentence.hpp"
#include "services/views/linearity/amplitude_linearity.hpp"
#include "services/views/report/stored_result.hpp"

namespace dyncal::inline views {

struct ReportContents {
  StoredResult result;
  std::optional<LaboratoryFile> laboratory;
  std::optional<SensorFile> sensor;
  std::vector<std::string> channels;           // those whose values are shown in full
  std::optional<ConformityReport> conformity;  // nothing: no tolerances
  std::optional<AmplitudeLinearity> linearity; // nothing: one level at each frequency
  std::vector<EmbeddedPicture> pictures;       // further figures of the run folder
  std::vector<std::string> left_out;           // pictures that could not be taken in, and why
  std::string number;                          // empty: none
  std::string replaces;                        // number of the report whose place it takes
  bool is_draft = true;                        // not issued: every page says so
  std::vector<TranslatedText> provenance;      // what the result was held against
  std::vector<TranslatedText> objections;      // in spite of which it is issued
  std::string issued;                          // YYYY-MM-DD
  std::string software;                        // that makes the report
  std::vector<Language> languages{Language::english};
  Language language = Language::english; // of the part that is being made
};

// What the values are traceable to: as the run states it, else the laboratory file; null: neither.
[[nodiscard]] const ReferenceStandard* reference_of(const ReportContents& contents);

// "80", with the level where there are several.
[[nodiscard]] std::string place_cell(const ReportContents& contents, const StoredPoint& point);

// Whose it is and what it is about (report_front.cpp).
[[nodiscard]] std::string letterhead(const ReportContents& contents);
// What a reader must know before any number: a run that was broken off, values that are missing.
[[nodiscard]] std::string warnings(const ReportContents& contents);
[[nodiscard]] std::string summary(const ReportContents& contents);
[[nodiscard]] std::string remarks(const ReportContents& contents);
[[nodiscard]] std::string signatures(const ReportContents& contents);
// "No. 2026-0042", or the run of a report without a number.
[[nodiscard]] std::string mark_of(const ReportContents& contents);
// The title, also that of the window and of the PDF.
[[nodiscard]] std::string title_of(const ReportContents& contents);
// "Physics laboratory, Musterstadt", or the bench without a laboratory file.
[[nodiscard]] std::string issuer_of(const ReportContents& contents);

// Values (report_results.cpp). Table, figures, group delay and budget of one channel; `number`
// numbers the SVG of the document.
[[nodiscard]] std::string channel_section(const ReportContents& contents,
                                          const std::string& channel, std::size_t number);
// Channels of the run that are not shown in full.
[[nodiscard]] std::string other_channels(const ReportContents& contents);
[[nodiscard]] std::string flag_section(const ReportContents& contents);
[[nodiscard]] std::string single_results(const ReportContents& contents);

// What u is made of (report_budget.cpp): at one reference frequency, as a table of quantities; at
// all of them, as a table of contributions over frequency. Empty without a budget.
[[nodiscard]] std::string budget_section(const ReportContents& contents,
                                         const std::string& channel);
[[nodiscard]] std::string budget_annex(const ReportContents& contents);

// How values change with the level (report_linearity.cpp); empty where there is one level.
[[nodiscard]] std::string linearity_section(const ReportContents& contents);

// What was decided of tolerances (report_conformity.cpp); empty without any.
[[nodiscard]] std::string conformity_section(const ReportContents& contents);

// Figures of the run folder, which are in English, with the facts of the sample clock in any
// language (report_clock.cpp). Empty where there are none.
[[nodiscard]] std::string clock_section(const ReportContents& contents);
[[nodiscard]] std::string interferometer_section(const ReportContents& contents);

// What they were measured with (report_setup.cpp).
[[nodiscard]] std::string conditions_section(const ReportContents& contents);
[[nodiscard]] std::string losses_section(const ReportContents& contents);
[[nodiscard]] std::string closures_section(const ReportContents& contents);
[[nodiscard]] std::string equipment_section(const ReportContents& contents);
[[nodiscard]] std::string devices_section(const ReportContents& contents);
[[nodiscard]] std::string software_section(const ReportContents& contents);
// What was noted of the run, and what happened in it.
[[nodiscard]] std::string journal_section(const ReportContents& contents);
[[nodiscard]] std::string recipe_section(const ReportContents& contents);

// How it looks, on the screen and on A4 paper: CSS without anything to fetch (report_style.cpp).
[[nodiscard]] std::string_view report_style();

} // namespace dyncal::inline views
