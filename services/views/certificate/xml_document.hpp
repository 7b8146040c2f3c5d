// An XML document in memory (libxml2), read with guards or built element by element.
//
// Reading takes UTF-8 only and refuses a DOCTYPE, so that no entity is ever declared, expanded or
// fetched; nothing outside the document is read, neither file nor network, and more than 64 MiB is
// refused. Text that is written is document_text() (figures/markup.hpp), escaped by libxml2.
//
// Fails (bad_file) with FILE:LINE and the reason. One thread at a time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"

// Of libxml2.
struct _xmlDoc;  // NOLINT(readability-identifier-naming)
struct _xmlNode; // NOLINT(readability-identifier-naming)

namespace dyncal::inline views {

inline constexpr const char* dcc_namespace = "https://ptb.de/dcc";
inline constexpr const char* si_namespace = "https://ptb.de/si";
inline constexpr const char* signature_namespace = "http://www.w3.org/2000/09/xmldsig#";

// One element; the document must outlive it.
class XmlElement {
public:
  explicit XmlElement(_xmlNode* node) : node_(node) {}

  // Adds an element behind the last one; "dcc:name" or "si:value".
  XmlElement add(std::string_view qualified_name);
  // The same with text in it.
  XmlElement add(std::string_view qualified_name, std::string_view text);
  XmlElement& attribute(const char* name, std::string_view value); // none of an empty value
  void remove(); // with all that is in it: not to be used any more

  [[nodiscard]] std::string name() const; // without its prefix
  [[nodiscard]] bool is(std::string_view name, std::string_view of_namespace) const;
  [[nodiscard]] std::string attribute(const char* name) const; // empty: not there
  [[nodiscard]] bool has_attribute(const char* name) const;
  [[nodiscard]] std::string text() const; // of all that is in it
  [[nodiscard]] std::vector<XmlElement> children() const;
  // Children of that name in the DCC or D-SI namespace, and the first of them.
  [[nodiscard]] std::vector<XmlElement> children(std::string_view name) const;
  [[nodiscard]] std::optional<XmlElement> child(std::string_view name) const;
  // All elements of that name within it, in the order of the document.
  [[nodiscard]] std::vector<XmlElement> descendants(std::string_view name,
                                                    std::string_view of_namespace) const;
  [[nodiscard]] _xmlNode* node() const { return node_; }

private:
  _xmlNode* node_;
};

class XmlDocument {
public:
  // A DCC with its root element and the namespaces dcc, si and xsi.
  [[nodiscard]] static XmlDocument make_dcc();
  // `name` is for messages.
  [[nodiscard]] static Expected<XmlDocument> parse(std::string_view text, const std::string& name);

  [[nodiscard]] XmlDocument copy() const;
  [[nodiscard]] XmlElement root() const;
  [[nodiscard]] std::string text() const; // UTF-8, with XML declaration
  [[nodiscard]] _xmlDoc* get() const { return document_.get(); }

private:
  struct Free {
    void operator()(_xmlDoc* document) const;
  };
  explicit XmlDocument(_xmlDoc* document) : document_(document) {}

  std::unique_ptr<_xmlDoc, Free> document_;
};

} // namespace dyncal::inline views
