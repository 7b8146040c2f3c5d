#include "services/views/document/report_document.hpp"

#include <algorithm>
#include <ctime>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/version.hpp"
#include "services/views/conformity/asked_conformity.hpp"
#include "services/views/document/html.hpp"
#include "services/views/lab_file/documented_conditions.hpp"
#include "services/views/language/report_sentences.hpp"
#include "services/views/language/translated_texts.hpp"
#include "services/views/objections/objections.hpp"
#include "services/views/objections/subject_objections.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/flag_legend.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

std::vector<std::string> channels_with_values(const StoredResult& result) {
  std::vector<std::string> names;
  for (const StoredValue& value : result.values) {
    if (std::find(names.begin(), names.end(), value.channel) == names.end()) {
      names.push_back(value.channel);
    }
  }
  return names;
}

// Those asked for, else those that respond, else all.
Expected<std::vector<std::string>> chosen_channels(const StoredResult& result,
                                                   const std::vector<std::string>& asked) {
  const std::vector<std::string> known = channels_with_values(result);
  for (const std::string& channel : asked) {
    if (std::find(known.begin(), known.end(), channel) == known.end()) {
      return fail(ErrorCode::bad_argument,
                  fmt::format("{}: channel '{}' has no value; this run has: {}",
                              result.file.string(), channel, fmt::join(known, ", ")));
    }
  }
  if (!asked.empty()) {
    return asked;
  }
  std::vector<std::string> responding = responding_channels(result);
  std::erase_if(responding, [&](const std::string& channel) {
    return std::ranges::find(known, channel) == known.end();
  });
  return responding.empty() ? known : responding;
}

// What the run folder has beside the transfer functions, which are drawn again.
void add_pictures(const std::filesystem::path& run, ReportContents& contents) {
  std::error_code unknown;
  if (!std::filesystem::is_directory(run, unknown)) {
    return;
  }
  std::vector<std::filesystem::path> paths;
  for (const std::filesystem::path& folder : {run, run / "figures"}) {
    for (std::filesystem::directory_iterator entry(folder, unknown), end; !unknown && entry != end;
         entry.increment(unknown)) {
      const std::string name = entry->path().filename().string();
      if (entry->path().extension() == ".svg" &&
          (name.starts_with("interval-") || name.starts_with("ellipse-"))) {
        paths.push_back(entry->path());
      }
    }
  }
  std::sort(paths.begin(), paths.end());
  for (const std::filesystem::path& path : paths) {
    auto picture = read_picture(path);
    if (picture) {
      contents.pictures.push_back(std::move(*picture));
    } else {
      contents.left_out.push_back(picture.error().message);
    }
  }
}

Expected<void> add_laboratory(const ReportRequest& request, ReportContents& contents) {
  if (!request.laboratory.empty()) {
    DYNCAL_TRY(contents.laboratory, read_laboratory_file(request.laboratory));
  }
  contents.sensor = request.sensor;
  if (contents.sensor) {
    amend(contents.result.journal, *contents.sensor);
  }
  return {};
}

// What may be issued states all that a document states, and nothing speaks against it.
Expected<void> check_issue(const ReportRequest& request, ReportContents& contents) {
  constexpr std::size_t date_length = 10;
  constexpr std::size_t max_shown = 5;
  if (!contents.laboratory || !contents.sensor || contents.number.empty()) {
    return fail(ErrorCode::bad_argument,
                "a report that is issued needs --lab, --sensor, and a number (--number, or in the "
                "sensor file)");
  }
  DYNCAL_TRY(const auto reference, documented_reference(contents.result, *contents.laboratory));
  const StoredResult& result = contents.result;
  if (result.began_utc.empty() || result.ended_utc.empty()) {
    return fail(ErrorCode::bad_argument,
                fmt::format("{}: the run does not know when it was measured, for its stamps are "
                            "not in UTC: no report of it is issued",
                            result.file.string()));
  }
  contents.objections = request.held.objections;
  std::ranges::move(objections_to(result, contents.channels),
                    std::back_inserter(contents.objections));
  std::ranges::move(objections_to_subject({.result = result,
                                           .channels = contents.channels,
                                           .sensor = *contents.sensor,
                                           .laboratory = *contents.laboratory,
                                           .reference = reference,
                                           .began = result.began_utc.substr(0, date_length),
                                           .ended = result.ended_utc.substr(0, date_length)}),
                    std::back_inserter(contents.objections));
  if (contents.objections.empty() || request.force) {
    return {};
  }
  return fail(
      ErrorCode::no_result,
      fmt::format(
          "{}: no report is issued: {}. Measure again, leave channels out with "
          "--channel, or --force a report that says all this",
          result.file.string(),
          fmt::join(first_of(texts_in(Language::english, contents.objections), max_shown), "; ")));
}

// Texts that stand at the edges of every page.
std::string running_texts(const ReportContents& contents) {
  const Language language = contents.language;
  const std::string foot =
      contents.laboratory && !contents.laboratory->letterhead.footer.empty()
          ? contents.laboratory->letterhead.footer
          : sentences::result_file_mark(language, contents.result.sha256.substr(0, 16));
  return element("div", issuer_of(contents), "running issuer-text") +
         element("div", fmt::format("{} {}", title_of(contents), mark_of(contents)),
                 "running subject-text") +
         element("div", foot, "running foot-text") +
         element("div", sentences::page, language, "running page-text") +
         element("div", sentences::of_pages, language, "running of-text");
}

// In one language; `first_figure` numbers the SVG of the document.
std::string part_of(const ReportContents& contents, std::size_t first_figure) {
  const Language language = contents.language;
  std::string html = fmt::format("<div class=\"part\" lang=\"{}\">\n", code_of(language));
  html += running_texts(contents) + letterhead(contents) + warnings(contents) + summary(contents);
  for (std::size_t i = 0; i < contents.channels.size(); ++i) {
    html += channel_section(contents, contents.channels[i], first_figure + i);
  }
  html += linearity_section(contents) + conformity_section(contents) + flag_section(contents) +
          closures_section(contents) + conditions_section(contents) + equipment_section(contents) +
          losses_section(contents) + clock_section(contents) + interferometer_section(contents) +
          remarks(contents) + signatures(contents);
  html += other_channels(contents) + devices_section(contents) + software_section(contents) +
          budget_annex(contents) + single_results(contents) + journal_section(contents) +
          recipe_section(contents);
  return html +
         element("p", sentences::end_of(language, title_of(contents), mark_of(contents)), "end") +
         "</div>\n";
}

// On every page of the document, whatever its language.
std::string watermark(const std::vector<Language>& languages) {
  std::vector<std::string> words;
  words.reserve(languages.size());
  for (const Language language : languages) {
    words.emplace_back(sentences::draft.in(language));
  }
  return element("div", fmt::format("{}", fmt::join(words, " / ")),
                 words.size() > 1 ? "draft several" : "draft");
}

std::string body_of(ReportContents contents) {
  std::string html = contents.is_draft ? watermark(contents.languages) : "";
  std::size_t figure = 1;
  for (const Language language : contents.languages) {
    contents.language = language;
    html += part_of(contents, figure);
    figure += contents.channels.size();
  }
  return html;
}

} // namespace

Expected<ReportContents> gather_report(const ReportRequest& request) {
  ReportContents contents;
  contents.is_draft = request.is_draft;
  contents.result = request.held.result;
  contents.provenance = request.held.statements;
  DYNCAL_TRY(contents.channels, chosen_channels(contents.result, request.channels));
  contents.result.flags = legend_of_channels(contents.result, contents.channels);
  if (const auto open = contents.result.open_closures(contents.channels);
      !open.empty() && !request.force) {
    return fail(ErrorCode::bad_argument,
                fmt::format("no report: what must hold over the run does not, so that its values "
                            "may be wrong: {}. Mend it and measure again, choose another "
                            "--channel, or --force a report that says all this",
                            fmt::join(open, "; ")));
  }
  DYNCAL_TRY(add_laboratory(request, contents));
  contents.number = request.number.empty() && contents.sensor ? contents.sensor->certificate_number
                                                              : request.number;
  contents.replaces = request.replaces;
  if (!request.languages.empty()) {
    contents.languages = request.languages;
  } else if (contents.laboratory) {
    contents.languages = contents.laboratory->languages;
  }
  contents.language = contents.languages.front();
  if (auto linearity = amplitude_linearity_of(contents.result, contents.channels, std::nullopt)) {
    contents.linearity = std::move(*linearity);
  }
  DYNCAL_TRY(contents.conformity,
             asked_conformity(contents.result, contents.channels, request.tolerances,
                              contents.sensor ? contents.sensor->tolerances : std::nullopt));
  if (!request.is_draft) {
    DYNCAL_TRY(check_issue(request, contents));
  }
  add_pictures(request.run, contents);
  contents.issued = fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr)));
  contents.software = software_version();
  return contents;
}

std::string report_html(const ReportContents& contents) {
  // The policy forbids a browser to fetch or run anything, whatever a text might hold.
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"{}\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; "
      "img-src data:; style-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<meta name=\"author\" content=\"{}\">\n<meta name=\"generator\" "
      "content=\"{}\">\n<title>{}</title>\n<style>{}</style>\n</head>\n"
      "<body>\n<main>\n{}</main>\n</body>\n</html>\n",
      code_of(contents.language), escaped(issuer_of(contents)), escaped(contents.software),
      escaped(fmt::format("{}, {}", title_of(contents),
                          sentences::run_mark(contents.language, contents.result.run))),
      report_style(), body_of(contents));
}

} // namespace dyncal::inline views
