// What the tests of figures ask of an SVG document.
#pragma once

#include <string>
#include <vector>

namespace dyncal::inline views::figures {

// Empty when the text is well-formed XML with the root <svg> and without a number that is none;
// else what is wrong.
std::string problem_of(const std::string& svg);

// How many elements of this name the document has.
std::size_t count_elements(const std::string& svg, const std::string& name);

// The content of all text elements, in order.
std::vector<std::string> texts_of(const std::string& svg);

} // namespace dyncal::inline views::figures
