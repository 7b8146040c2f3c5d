#include "drivers/can/dbc/dbc_keywords.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "drivers/can/dbc/dbc_scanner.hpp"

namespace dyncal::drivers::can {

namespace {

constexpr auto passed_over = std::to_array<std::string_view>({"VERSION",
                                                              "BS_",
                                                              "VAL_TABLE_",
                                                              "VAL_",
                                                              "CM_",
                                                              "EV_",
                                                              "ENVVAR_DATA_",
                                                              "EV_DATA_",
                                                              "SGTYPE_",
                                                              "SIGTYPE_",
                                                              "SIG_TYPE_REF_",
                                                              "SIG_GROUP_",
                                                              "BO_TX_BU_",
                                                              "BA_DEF_REL_",
                                                              "BA_REL_",
                                                              "BA_DEF_DEF_REL_",
                                                              "BU_SG_REL_",
                                                              "BU_EV_REL_",
                                                              "BU_BO_REL_",
                                                              "CAT_DEF_",
                                                              "CAT_",
                                                              "FILTER",
                                                              "SGTYPE_VAL_",
                                                              "SIGTYPE_VALTYPE_",
                                                              "BA_DEF_SGTYPE_",
                                                              "BA_SGTYPE_",
                                                              "BA_DEF_DEF_SGTYPE_",
                                                              "NS_DESC_"});

constexpr auto decisive = std::to_array<std::string_view>(
    {"NS_", "SIG_VALTYPE_", "SG_MUL_VAL_", "BA_DEF_", "BA_DEF_DEF_", "BA_"});

// Stand behind the name of an attribute, not at the begin of a statement.
constexpr auto objects_of_relations =
    std::to_array<std::string_view>({"BU_SG_REL_", "BU_EV_REL_", "BU_BO_REL_"});

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

} // namespace

bool is_passed_over(std::string_view keyword) {
  return is_one_of(passed_over, keyword);
}

bool begins_statement(std::string_view text) {
  DbcScanner scanner(text);
  const std::string keyword = scanner.name().value_or("");
  if (keyword == "BO_") {
    return scanner.unsigned_integer() && scanner.name() && scanner.character(':');
  }
  if (keyword == "SG_") {
    const bool named = scanner.name().has_value();
    return named && (scanner.character(':') || (scanner.name() && scanner.character(':')));
  }
  if (keyword == "BU_") {
    return scanner.character(':');
  }
  if (keyword == "EV_") {
    return scanner.name() && scanner.character(':');
  }
  return is_one_of(decisive, keyword) ||
         (is_one_of(passed_over, keyword) && !is_one_of(objects_of_relations, keyword));
}

} // namespace dyncal::drivers::can
