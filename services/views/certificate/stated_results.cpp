#include "services/views/certificate/stated_results.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/core.h>

namespace dyncal::inline views {
namespace {

std::vector<std::string> items_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> items;
  std::string item;
  while (stream >> item) {
    items.push_back(item);
  }
  return items;
}

// A list's own lists and those of its uncertainty, by name.
void add_lists(const XmlElement& element, StatedList& list) {
  for (const XmlElement& child : element.children()) {
    if (child.children().empty()) {
      list[child.name()] = items_of(child.text());
    } else {
      add_lists(child, list);
    }
  }
}

StatedQuantity quantity_of(const XmlElement& element) {
  StatedQuantity quantity{element.attribute("refType"), {}};
  for (const XmlElement& list : element.descendants("realListXMLList", si_namespace)) {
    StatedList lists;
    add_lists(list, lists);
    quantity.lists.push_back(std::move(lists));
  }
  return quantity;
}

std::string shown(const std::vector<std::string>& items, std::size_t i) {
  return i < items.size() ? items[i] : "not there";
}

std::optional<std::string> difference_of(const std::string& what,
                                         const std::vector<std::string>& certificate,
                                         const std::vector<std::string>& run) {
  for (std::size_t i = 0; i < std::max(certificate.size(), run.size()); ++i) {
    if (i >= certificate.size() || i >= run.size() || certificate[i] != run[i]) {
      return fmt::format("{}, item {}: {} in the certificate, {} by the run", what, i + 1,
                         shown(certificate, i), shown(run, i));
    }
  }
  return std::nullopt;
}

std::optional<std::string> difference_of(const std::string& result,
                                         const StatedQuantity& certificate,
                                         const StatedQuantity& run) {
  const std::string what = fmt::format("{}: {}", result, run.type);
  if (certificate.type != run.type || certificate.lists.size() != run.lists.size()) {
    return fmt::format("{}: another quantity ({}) in the certificate", what, certificate.type);
  }
  for (std::size_t i = 0; i < run.lists.size(); ++i) {
    for (const auto& [name, items] : run.lists[i]) {
      const auto found = certificate.lists[i].find(name);
      const auto stated =
          found == certificate.lists[i].end() ? std::vector<std::string>() : found->second;
      if (auto difference = difference_of(what + ", " + name, stated, items)) {
        return difference;
      }
    }
    if (certificate.lists[i].size() != run.lists[i].size()) {
      return what + ": the certificate has a list that the run does not give";
    }
  }
  return std::nullopt;
}

} // namespace

std::optional<StatedResults> stated_results(const XmlElement& results) {
  StatedResults stated;
  for (const XmlElement& result : results.children("result")) {
    const auto name = result.child("name");
    if (!name) {
      return std::nullopt;
    }
    const auto content = name->child("content"); // the first language
    std::string text = content ? content->text() : name->text();
    text.erase(0, text.find_first_not_of(" \n\t"));
    text.erase(text.find_last_not_of(" \n\t") + 1);
    std::vector<StatedQuantity> quantities;
    for (const XmlElement& quantity : result.descendants("quantity", dcc_namespace)) {
      quantities.push_back(quantity_of(quantity));
    }
    if (!stated.emplace(text, std::move(quantities)).second) {
      return std::nullopt;
    }
  }
  return stated;
}

std::optional<std::string> difference_between(const StatedResults& certificate,
                                              const StatedResults& run) {
  for (const auto& [name, quantities] : run) {
    const auto found = certificate.find(name);
    if (found == certificate.end() || found->second.size() != quantities.size()) {
      return name + ": not in the certificate, or with other quantities";
    }
    for (std::size_t i = 0; i < quantities.size(); ++i) {
      if (auto difference = difference_of(name, found->second[i], quantities[i])) {
        return difference;
      }
    }
  }
  return certificate.size() == run.size()
             ? std::nullopt
             : std::optional<std::string>(
                   "the certificate has a result that the run does not give");
}

std::size_t count_of_values(const StatedResults& results) {
  std::size_t count = 0;
  for (const auto& [name, quantities] : results) {
    for (const StatedQuantity& quantity : quantities) {
      for (const StatedList& list : quantity.lists) {
        const auto values = list.find("valueXMLList");
        count += values == list.end() ? 0 : values->second.size();
      }
    }
  }
  return count;
}

} // namespace dyncal::inline views
