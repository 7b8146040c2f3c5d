#include "services/bench/file/acs_drivers.hpp"

#include <algorithm>
#include <array>

#include "drivers/text_stream/text_stream.hpp"
#include "services/bench/file/driver_tables.hpp"

namespace dyncal::inline bench {

std::span<const drivers::AcsDriver* const> acs_drivers() {
  static const std::array rows{
      &drivers::text_stream::driver(),
  };
  return rows;
}

const drivers::AcsDriver* acs_driver_named(std::string_view name) {
  const auto rows = acs_drivers();
  const auto found = std::ranges::find(
      rows, name, [](const drivers::AcsDriver* row) { return std::string_view(row->name); });
  return found == rows.end() ? nullptr : *found;
}

AcsSourceSettings read_acs_source(TomlTable& table, const drivers::AcsDriver& driver) {
  AcsSourceSettings source{.driver = driver.name};
  for (const drivers::AcsTextKey& key : driver.texts) {
    source.texts.emplace(key.name, table.text(key.name));
    if (!table.has(key.name)) {
      table.refuse(key.name, std::string("is missing: ") + key.meaning);
    }
  }
  for (const drivers::AcsNumberKey& key : driver.numbers) {
    const auto value = table.optional_number(key.name, key.unit);
    source.numbers.emplace(key.name, value.value_or(key.otherwise.value_or(0.0)));
    if (!table.has(key.name) && !key.otherwise) {
      table.refuse(key.name, std::string("is missing: a number in ") + key.unit);
    }
  }
  return source;
}

} // namespace dyncal::inline bench
