#include "services/views/certificate/xml_document.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/core.h>
#include <libxml/parser.h>
#include <libxml/tree.h>

#include "services/views/figures/markup.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::size_t max_document_bytes = 64U << 20U;
constexpr const char* schema_instance_namespace = "http://www.w3.org/2001/XMLSchema-instance";

const xmlChar* xml_text(const char* text) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how libxml2 spells UTF-8
  return reinterpret_cast<const xmlChar*>(text);
}

std::string from_xml(const xmlChar* text) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): how libxml2 spells UTF-8
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
}

xmlNs* namespace_of(xmlNode* node, std::string_view prefix) {
  return xmlSearchNs(node->doc, node, xml_text(std::string(prefix).c_str()));
}

tl::unexpected<Error> refused(const std::string& name, const std::string& reason) {
  return fail(ErrorCode::bad_file, fmt::format("{}: {}", name, reason));
}

// The XML declaration names no other encoding.
bool declares_utf_8(std::string_view text) {
  if (!text.starts_with("<?xml")) {
    return true;
  }
  std::string declaration(text.substr(0, text.find("?>")));
  std::transform(declaration.begin(), declaration.end(), declaration.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return declaration.find("encoding") == std::string::npos ||
         declaration.find("\"utf-8\"") != std::string::npos ||
         declaration.find("'utf-8'") != std::string::npos;
}

// What would give the parser something to declare, expand or fetch, or hide that it does.
std::optional<std::string> danger_in(std::string_view text) {
  if (text.size() > max_document_bytes) {
    return "is larger than 64 MiB, which no certificate needs";
  }
  if (text.find('\0') != std::string_view::npos || text.starts_with("\xff\xfe") ||
      text.starts_with("\xfe\xff") || !declares_utf_8(text)) {
    return "is not XML in UTF-8, in which certificates are read";
  }
  const std::size_t declared = text.find("<!");
  for (std::size_t at = declared; at != std::string_view::npos; at = text.find("<!", at + 2)) {
    const std::string_view rest = text.substr(at);
    if (!rest.starts_with("<!--") && !rest.starts_with("<![CDATA[")) {
      return "has a DOCTYPE or declares entities, which no certificate needs and which may fetch "
             "files or fill the memory";
    }
  }
  return std::nullopt;
}

void collect(xmlNode* node, std::string_view name, std::string_view of_namespace,
             std::vector<XmlElement>& found) {
  for (xmlNode* child = node->children; child != nullptr; child = child->next) {
    if (child->type != XML_ELEMENT_NODE) {
      continue;
    }
    if (XmlElement(child).is(name, of_namespace)) {
      found.emplace_back(child);
    }
    collect(child, name, of_namespace, found);
  }
}

} // namespace

XmlElement XmlElement::add(std::string_view qualified_name) {
  const std::size_t colon = qualified_name.find(':');
  const std::string name(qualified_name.substr(colon + 1));
  return XmlElement(xmlNewChild(node_, namespace_of(node_, qualified_name.substr(0, colon)),
                                xml_text(name.c_str()), nullptr));
}

XmlElement XmlElement::add(std::string_view qualified_name, std::string_view text) {
  XmlElement child = add(qualified_name);
  xmlNode* content = xmlNewText(xml_text(document_text(text).c_str()));
  xmlAddChild(child.node_, content);
  return child;
}

XmlElement& XmlElement::attribute(const char* name, std::string_view value) {
  if (!value.empty()) {
    xmlNewProp(node_, xml_text(name), xml_text(document_text(value).c_str()));
  }
  return *this;
}

void XmlElement::remove() {
  xmlUnlinkNode(node_);
  xmlFreeNode(node_);
  node_ = nullptr;
}

std::string XmlElement::name() const {
  return from_xml(node_->name);
}

bool XmlElement::is(std::string_view name, std::string_view of_namespace) const {
  return from_xml(node_->name) == name && node_->ns != nullptr &&
         from_xml(node_->ns->href) == of_namespace;
}

bool XmlElement::has_attribute(const char* name) const {
  return xmlHasProp(node_, xml_text(name)) != nullptr;
}

std::string XmlElement::attribute(const char* name) const {
  xmlChar* value = xmlGetProp(node_, xml_text(name));
  std::string text = from_xml(value);
  xmlFree(value);
  return text;
}

std::string XmlElement::text() const {
  xmlChar* value = xmlNodeGetContent(node_);
  std::string text = from_xml(value);
  xmlFree(value);
  return text;
}

std::vector<XmlElement> XmlElement::children() const {
  std::vector<XmlElement> found;
  for (xmlNode* child = node_->children; child != nullptr; child = child->next) {
    if (child->type == XML_ELEMENT_NODE) {
      found.emplace_back(child);
    }
  }
  return found;
}

std::vector<XmlElement> XmlElement::children(std::string_view name) const {
  std::vector<XmlElement> found;
  for (const XmlElement& child : children()) {
    if (child.is(name, dcc_namespace) || child.is(name, si_namespace)) {
      found.push_back(child);
    }
  }
  return found;
}

std::optional<XmlElement> XmlElement::child(std::string_view name) const {
  const std::vector<XmlElement> found = children(name);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

std::vector<XmlElement> XmlElement::descendants(std::string_view name,
                                                std::string_view of_namespace) const {
  std::vector<XmlElement> found;
  collect(node_, name, of_namespace, found);
  return found;
}

void XmlDocument::Free::operator()(_xmlDoc* document) const {
  xmlFreeDoc(document);
}

XmlDocument XmlDocument::make_dcc() {
  XmlDocument document(xmlNewDoc(xml_text("1.0")));
  xmlNode* root =
      xmlNewDocNode(document.get(), nullptr, xml_text("digitalCalibrationCertificate"), nullptr);
  xmlDocSetRootElement(document.get(), root);
  xmlNs* dcc = xmlNewNs(root, xml_text(dcc_namespace), xml_text("dcc"));
  xmlNewNs(root, xml_text(si_namespace), xml_text("si"));
  xmlNs* instance = xmlNewNs(root, xml_text(schema_instance_namespace), xml_text("xsi"));
  xmlSetNs(root, dcc);
  xmlNewNsProp(root, instance, xml_text("schemaLocation"),
               xml_text("https://ptb.de/dcc https://ptb.de/dcc/v3.3.0/dcc.xsd"));
  xmlNewProp(root, xml_text("schemaVersion"), xml_text("3.3.0"));
  return document;
}

Expected<XmlDocument> XmlDocument::parse(std::string_view text, const std::string& name) {
  if (const auto danger = danger_in(text)) {
    return refused(name, *danger);
  }
  xmlParserCtxt* context = xmlNewParserCtxt();
  xmlDoc* document =
      xmlCtxtReadMemory(context, text.data(), static_cast<int>(text.size()), nullptr, "UTF-8",
                        XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING);
  const xmlError* error = xmlCtxtGetLastError(context);
  std::string reason = "not XML";
  int line = 0;
  if (error != nullptr && error->message != nullptr) {
    reason = error->message;
    line = error->line;
    reason.erase(reason.find_last_not_of("\r\n ") + 1);
  }
  xmlFreeParserCtxt(context);
  if (document == nullptr) {
    return refused(fmt::format("{}:{}", name, line), "is not well-formed XML: " + reason);
  }
  XmlDocument parsed(document);
  if (xmlGetIntSubset(document) != nullptr) {
    return refused(name, "has a DOCTYPE");
  }
  if (xmlDocGetRootElement(document) == nullptr) {
    return refused(name, "has no element");
  }
  return parsed;
}

XmlDocument XmlDocument::copy() const {
  return XmlDocument(xmlCopyDoc(document_.get(), 1));
}

XmlElement XmlDocument::root() const {
  return XmlElement(xmlDocGetRootElement(document_.get()));
}

std::string XmlDocument::text() const {
  xmlChar* bytes = nullptr;
  int size = 0;
  xmlDocDumpMemoryEnc(document_.get(), &bytes, &size, "UTF-8");
  std::string text = from_xml(bytes);
  xmlFree(bytes);
  return text;
}

} // namespace dyncal::inline views
