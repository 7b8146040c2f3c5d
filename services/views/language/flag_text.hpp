// What the flags of results mean, in the languages of documents: without advice, which is for those
// who measure. In English a result explains its flags itself. Any thread.
#pragma once

#include <string_view>

#include "services/evaluation/result/result_flag.hpp"

namespace dyncal::inline views {

[[nodiscard]] std::string_view german_meaning_of(ResultFlag flag);

} // namespace dyncal::inline views
