#include "tests/unit/services/views/figures/well_formed.hpp"

#include <functional>

#include <tinyxml2.h>

namespace dyncal::inline views::figures {
namespace {

void visit(const tinyxml2::XMLElement* element,
           const std::function<void(const tinyxml2::XMLElement&)>& see) {
  for (; element != nullptr; element = element->NextSiblingElement()) {
    see(*element);
    visit(element->FirstChildElement(), see);
  }
}

} // namespace

std::string problem_of(const std::string& svg) {
  tinyxml2::XMLDocument document;
  if (document.Parse(svg.data(), svg.size()) != tinyxml2::XML_SUCCESS) {
    return document.ErrorStr();
  }
  if (document.RootElement() == nullptr || std::string(document.RootElement()->Name()) != "svg") {
    return "the root is not <svg>";
  }
  std::string problem;
  visit(document.RootElement(), [&](const auto& element) {
    for (const auto* attribute = element.FirstAttribute(); attribute != nullptr;
         attribute = attribute->Next()) {
      const std::string value = attribute->Value();
      const bool family = std::string(attribute->Name()) == "font-family";
      if (!family &&
          (value.find("nan") != std::string::npos || value.find("inf") != std::string::npos)) {
        problem = std::string(element.Name()) + " " + attribute->Name() + "=" + value;
      }
    }
  });
  return problem;
}

std::size_t count_elements(const std::string& svg, const std::string& name) {
  tinyxml2::XMLDocument document;
  document.Parse(svg.data(), svg.size());
  std::size_t count = 0;
  visit(document.RootElement(),
        [&](const auto& element) { count += element.Name() == name ? 1 : 0; });
  return count;
}

std::vector<std::string> texts_of(const std::string& svg) {
  tinyxml2::XMLDocument document;
  document.Parse(svg.data(), svg.size());
  std::vector<std::string> texts;
  visit(document.RootElement(), [&](const auto& element) {
    if (std::string(element.Name()) == "text" && element.GetText() != nullptr) {
      texts.emplace_back(element.GetText());
    }
  });
  return texts;
}

} // namespace dyncal::inline views::figures
