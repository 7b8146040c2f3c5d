// The few elements of HTML that a document needs, as text. Everything that comes from a file is
// escaped (markup.hpp), so that no name in a result or laboratory file becomes markup. Any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "services/views/figures/markup.hpp" // escaped(), for those who compose HTML
#include "services/views/language/sentence.hpp"

namespace dyncal::inline views {

// "<h2>text</h2>" and the like, with its text escaped.
[[nodiscard]] std::string element(std::string_view name, std::string_view text,
                                  std::string_view css_class = {});

// The same of a text of documents.
[[nodiscard]] std::string element(std::string_view name, const Sentence& text, Language language,
                                  std::string_view css_class = {});
// Cells of a table's head.
[[nodiscard]] std::vector<std::string> head_of(Language language,
                                               const std::vector<Sentence>& texts);

// A table whose head is repeated on every page that it reaches.
class HtmlTable {
public:
  // `head` is HTML: units and indices may be marked up. Fits the columns from the left.
  HtmlTable(std::string css_class, std::vector<std::string> head);

  // Text cells are escaped; `html_row` takes cells that are HTML already.
  void row(const std::vector<std::string>& cells);
  void html_row(const std::vector<std::string>& cells);
  [[nodiscard]] bool empty() const { return body_.empty(); }
  [[nodiscard]] std::string finish() const;

private:
  std::string css_class_;
  std::vector<std::string> head_;
  std::string body_;
};

// Names and what they stand for, in two columns; entries with an empty text are left out.
class DefinitionTable {
public:
  explicit DefinitionTable(Language language = Language::english) : language_(language) {}

  void add(std::string_view name, std::string_view text);
  void add(const Sentence& name, std::string_view text) { add(name.in(language_), text); }
  // The same with text that is HTML already.
  void add_html(std::string_view name, std::string_view html);
  [[nodiscard]] std::string finish() const;

private:
  Language language_;
  std::string body_;
};

} // namespace dyncal::inline views
