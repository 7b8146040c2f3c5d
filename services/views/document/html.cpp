#include "services/views/document/html.hpp"

#include <fmt/core.h>

namespace dyncal::inline views {

std::string element(std::string_view name, std::string_view text, std::string_view css_class) {
  return css_class.empty()
             ? fmt::format("<{0}>{1}</{0}>\n", name, escaped(text))
             : fmt::format("<{0} class=\"{2}\">{1}</{0}>\n", name, escaped(text), css_class);
}

std::string element(std::string_view name, const Sentence& text, Language language,
                    std::string_view css_class) {
  return element(name, text.in(language), css_class);
}

std::vector<std::string> head_of(Language language, const std::vector<Sentence>& texts) {
  std::vector<std::string> head;
  head.reserve(texts.size());
  for (const Sentence& text : texts) {
    head.emplace_back(text.in(language));
  }
  return head;
}

HtmlTable::HtmlTable(std::string css_class, std::vector<std::string> head)
    : css_class_(std::move(css_class)), head_(std::move(head)) {}

void HtmlTable::row(const std::vector<std::string>& cells) {
  std::vector<std::string> html;
  for (const std::string& cell : cells) {
    html.push_back(escaped(cell));
  }
  html_row(html);
}

void HtmlTable::html_row(const std::vector<std::string>& cells) {
  body_ += "<tr>";
  for (const std::string& cell : cells) {
    body_ += fmt::format("<td>{}</td>", cell);
  }
  body_ += "</tr>\n";
}

std::string HtmlTable::finish() const {
  std::string text = fmt::format("<table class=\"{}\">\n<thead><tr>", css_class_);
  for (const std::string& cell : head_) {
    text += fmt::format("<th>{}</th>", cell);
  }
  return text + "</tr></thead>\n<tbody>\n" + body_ + "</tbody>\n</table>\n";
}

void DefinitionTable::add(std::string_view name, std::string_view text) {
  if (!text.empty()) {
    add_html(name, escaped(text));
  }
}

void DefinitionTable::add_html(std::string_view name, std::string_view html) {
  if (!html.empty()) {
    body_ += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", escaped(name), html);
  }
}

std::string DefinitionTable::finish() const {
  return body_.empty() ? "" : "<table class=\"facts\"><tbody>\n" + body_ + "</tbody></table>\n";
}

} // namespace dyncal::inline views
