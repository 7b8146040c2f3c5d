#include <fmt/core.h>

#include "services/bench/file/bench_tables.hpp"

namespace dyncal::inline bench {

namespace {

GeneratorDriver read_driver(TomlTable& table) {
  const std::string name = table.one_of("driver", {"scpi", "by-hand", "none"}, "");
  if (name == "scpi") {
    return GeneratorDriver::scpi;
  }
  return name == "by-hand" ? GeneratorDriver::by_hand : GeneratorDriver::none;
}

} // namespace

GeneratorSettings read_generator(TomlTable table, const ExcitationSettings& excitation) {
  GeneratorSettings generator;
  generator.driver = read_driver(table);
  generator.level_per_volt =
      table.number("level_per_volt", generator.level_per_volt, "m/s^2 per V");
  // Never guessed: the exciter is driven too hard by the factor in which it is wrong.
  if (generator.driver != GeneratorDriver::none && !table.has("level_per_volt")) {
    table.refuse("level_per_volt",
                 "is missing: the level at the exciter in m/s^2 for one volt (amplitudes) of the "
                 "generator, which a measurement with a small voltage shows");
  }
  generator.address =
      is_instrument(generator.driver) ? table.required_text("address") : table.text("address");
  if (generator.level_per_volt <= 0.0) {
    table.refuse("level_per_volt", "must be positive, in m/s^2 per V");
  }
  const auto read_limit = [&](const char* key, const char* unit, std::optional<double>& limit) {
    limit = table.optional_number(key, unit);
    if (limit && *limit <= 0.0) {
      table.refuse(key, "must be positive");
    }
  };
  read_limit("level_tolerance_rel", "parts of the level", generator.level_tolerance_rel);
  read_limit("maximum_voltage_v", "V, zero to peak", generator.maximum_voltage_v);
  read_limit("maximum_level_m_s2", "m/s^2", generator.maximum_level_m_s2);
  read_limit("maximum_velocity_m_s", "m/s", generator.maximum_velocity_m_s);
  read_limit("maximum_displacement_mm", "mm", generator.maximum_displacement_mm);
  if (generator.level_tolerance_rel && !is_instrument(generator.driver)) {
    table.refuse(
        "level_tolerance_rel",
        "needs driver = \"scpi\": a level is only brought to its value in time by an instrument");
  }
  if (generator.level_tolerance_rel && excitation.settling_from_data) {
    table.refuse("level_tolerance_rel", "cannot go with excitation.settling = \"from-data\": the "
                                        "level is still being set while the samples look settled");
  }
  table.finish();
  return generator;
}

void check_generator(TomlTable table, const BenchFile& file) {
  if (file.excitation.multisine && file.generator.driver == GeneratorDriver::by_hand) {
    table.refuse("driver", "\"by-hand\" cannot excite a multi-sine: an instrument has to be given "
                           "its waveform (\"scpi\"), or records are evaluated (\"none\")");
  }
  const SourceSettings* reference = file.source(file.method.reference.source);
  if (file.generator.level_tolerance_rel && reference != nullptr &&
      reference->is<TableSourceSettings>()) {
    table.refuse("level_tolerance_rel",
                 fmt::format("needs samples of the reference while a step is excited, but source "
                             "'{}' is a table; leave it out",
                             reference->name));
  }
}

} // namespace dyncal::inline bench
