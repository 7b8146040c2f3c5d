#include "services/bench/file/oscilloscope_source.hpp"

#include "services/bench/file/address_or_folder.hpp"

namespace dyncal::inline bench {

OscilloscopeSourceSettings read_oscilloscope_source(TomlTable& table, NamedFiles& files) {
  OscilloscopeSourceSettings oscilloscope;
  read_address_or_folder(table, files,
                         "where the oscilloscope answers, or the folder with files of its shots",
                         oscilloscope.address, oscilloscope.path);
  oscilloscope.family = table.text("family");
  oscilloscope.sync_input = table.whole_number("sync_input", oscilloscope.sync_input, 1);
  oscilloscope.sync_range_v =
      table.number("sync_range_v", oscilloscope.sync_range_v, "V peak to peak");
  oscilloscope.trigger_level_v = table.number("trigger_level_v", oscilloscope.trigger_level_v, "V");
  if (oscilloscope.sync_range_v <= 0.0) {
    table.refuse("sync_range_v", "must be positive, in V peak to peak");
  }
  return oscilloscope;
}

} // namespace dyncal::inline bench
