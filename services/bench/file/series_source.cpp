#include "services/bench/file/series_source.hpp"

#include "services/bench/file/address_or_folder.hpp"

namespace dyncal::inline bench {

SeriesSourceSettings read_series_source(TomlTable& table, NamedFiles& files) {
  SeriesSourceSettings series;
  read_address_or_folder(table, files,
                         "where the sensor sends its series, or the folder it writes them into",
                         series.address, series.path);
  return series;
}

} // namespace dyncal::inline bench
