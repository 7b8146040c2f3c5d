#include "drivers/files/dump_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "drivers/files/file_channels.hpp"
#include "drivers/files/receiver_channels.hpp"
#include "drivers/files/regular_stamps.hpp"

namespace dyncal::drivers::files {
namespace {

using Json = nlohmann::json;

constexpr std::size_t columns_of_unit = 16;
constexpr std::size_t columns_before = 5; // id to time_uncertainty
constexpr std::uint64_t numbers_of_unit = std::uint64_t{1} << 32U;
constexpr std::uint64_t second_ns = 1'000'000'000;
constexpr std::uint64_t max_second = 9'000'000'000; // the year 2255: nanoseconds hold in 63 bits

std::string data_name(std::size_t column) {
  return std::string("Data_") + (column < 9 ? "0" : "") + std::to_string(column + 1);
}

// What the first line says of one column.
struct Declared {
  std::string quantity;
  std::string unit;
  std::string hierarchy;
  double minimum = 0.0;
  double maximum = 0.0;
  double steps = 0.0;
};

std::string text_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : "";
}
double number_in(const Json& json, const char* key) {
  const auto found = json.find(key);
  const double number = found != json.end() && found->is_number() ? found->get<double>() : 0.0;
  return std::isfinite(number) ? number : 0.0;
}

std::map<std::size_t, Declared> declared_columns(const Json& json) {
  std::map<std::size_t, Declared> declared;
  for (std::size_t column = 0; column < columns_of_unit; ++column) {
    const auto found = json.find(std::to_string(column + 1));
    if (found != json.end() && found->is_object()) {
      declared[column] = {text_in(*found, "PHYSICAL_QUANTITY"), text_in(*found, "UNIT"),
                          text_in(*found, "HIERARCHY"),         number_in(*found, "MIN_SCALE"),
                          number_in(*found, "MAX_SCALE"),       number_in(*found, "RESOLUTION")};
    }
  }
  return declared;
}

// The group of "Group/index".
std::string group_of(const std::string& hierarchy) {
  return hierarchy.substr(0, hierarchy.find('/'));
}

std::string name_of(std::size_t column, const std::map<std::size_t, Declared>& declared) {
  const auto found = declared.find(column);
  const std::string group = found == declared.end() ? "" : group_of(found->second.hierarchy);
  if (group.empty()) {
    return data_name(column);
  }
  std::size_t members = 0;
  std::size_t before = 0;
  for (const auto& [other, one] : declared) {
    if (group_of(one.hierarchy) == group) {
      before += other < column ? 1 : 0;
      ++members;
    }
  }
  return receiver_channel(group, before, members);
}

template <class Number>
bool take_number(std::string_view& line, Number& value) {
  const auto [end, status] = std::from_chars(line.data(), line.data() + line.size(), value);
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  const bool ends = line.empty() || line.front() == ';';
  line.remove_prefix(line.empty() || !ends ? 0 : 1);
  return status == std::errc() && ends;
}

} // namespace

Expected<std::unique_ptr<DumpReader>> DumpReader::open(const FileSettings& settings) {
  DYNCAL_TRY(auto file, MappedFile::open(settings.path));
  std::unique_ptr<DumpReader> reader(new DumpReader(settings, std::move(file)));
  DYNCAL_TRY(reader->read_description());
  DYNCAL_TRY(reader->read_names());
  return reader;
}

tl::unexpected<Error> DumpReader::malformed(const std::string& problem) const {
  return fail(ErrorCode::malformed,
              settings_.path.string() + ":" + std::to_string(line_) + ": " + problem);
}

std::optional<std::string_view> DumpReader::next_line() {
  if (rest_.empty()) {
    return std::nullopt;
  }
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++line_;
  if (line.ends_with('\r')) {
    line.remove_suffix(1);
  }
  return line;
}

Expected<void> DumpReader::read_description() {
  const auto line = next_line();
  line_ = 1;
  const Json json = line ? Json::parse(*line, nullptr, false) : Json();
  if (!json.is_object()) {
    return malformed("a dump of the SmartUp receiver begins with the sensor's description (JSON); "
                     "this file is not one");
  }
  const auto declared = declared_columns(json);
  std::vector<std::string> names;
  for (std::size_t column = 0; column < columns_of_unit; ++column) {
    const std::string name = name_of(column, declared);
    if (declared.contains(column) || settings_.channels.contains(name)) {
      columns_.push_back(column);
      names.push_back(name);
    }
  }
  if (names.empty()) {
    return malformed("describes no channel");
  }
  DYNCAL_TRY(description_, describe_file_channels(settings_, names));
  description_.device = text_in(json, "Name");
  description_.stamp_instant = StampInstant::data_ready_edge;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const auto found = declared.find(columns_[i]);
    if (found == declared.end()) {
      continue;
    }
    ChannelDescription& channel = description_.channels[i];
    channel.quantity = found->second.quantity;
    channel.unit = channel.unit.empty() ? found->second.unit : channel.unit;
    channel.minimum = found->second.minimum;
    channel.maximum = found->second.maximum;
    channel.resolution =
        found->second.steps > 0.0 ? (channel.maximum - channel.minimum) / found->second.steps : 0.0;
  }
  return {};
}

Expected<void> DumpReader::read_names() {
  const auto line = next_line();
  constexpr std::string_view names =
      "id;sample_number;unix_time;unix_time_nsecs;time_uncertainty;Data_01";
  if (!line || !line->starts_with(names)) {
    line_ = 2;
    return malformed("must name the columns: " + std::string(names) + ";...");
  }
  return {};
}

tl::expected<DumpReader::Row, std::string> DumpReader::parse(std::string_view line) const {
  Row row;
  std::uint64_t second = 0;
  std::uint64_t nanoseconds = 0;
  std::uint32_t uncertainty = 0;
  if (!take_number(line, row.sensor) || !take_number(line, row.number) ||
      !take_number(line, second) || !take_number(line, nanoseconds) ||
      !take_number(line, uncertainty)) {
    return tl::unexpected("the first " + std::to_string(columns_before) +
                          " fields must be whole numbers");
  }
  if (row.number >= numbers_of_unit || second > max_second || nanoseconds >= second_ns) {
    return tl::unexpected(std::string("sample number or time is out of range"));
  }
  row.stamp_ns = static_cast<std::int64_t>(second * second_ns + nanoseconds);
  row.u_stamp_ns = receiver_uncertainty_ns(uncertainty);
  std::size_t column = 0;
  for (std::array<double, columns_of_unit> values{}; column < columns_of_unit; ++column) {
    if (!take_number(line, values[column])) {
      return tl::unexpected("field " + data_name(column) + " is not a number");
    }
    if (std::find(columns_.begin(), columns_.end(), column) != columns_.end()) {
      row.values.push_back(values[column]);
    }
  }
  std::uint64_t ticks = 0;
  if (!line.empty() && !(take_number(line, ticks) && line.empty())) {
    return tl::unexpected(std::string("has more fields than a dump has"));
  }
  return row;
}

Expected<std::optional<DumpReader::Row>> DumpReader::next_row() {
  const auto line = next_line();
  if (!line) {
    return std::optional<Row>();
  }
  auto row = parse(*line);
  if (!row) {
    return malformed(row.error());
  }
  if (sensor_.value_or(row->sensor) != row->sensor) {
    return malformed("is of another sensor (id " + std::to_string(row->sensor) +
                     ") than the rows "
                     "before");
  }
  sensor_ = row->sensor;
  if (last_sample_) {
    // The 32 bits of the unit, counted on.
    const std::uint64_t turns = *last_sample_ / numbers_of_unit;
    const bool wrapped = *last_sample_ % numbers_of_unit > numbers_of_unit / 4 * 3 &&
                         row->number < numbers_of_unit / 4;
    row->number += (turns + (wrapped ? 1 : 0)) * numbers_of_unit;
    if (row->number <= *last_sample_) {
      return malformed(not_rising(row->number, *last_sample_));
    }
  }
  last_sample_ = row->number;
  return std::optional(std::move(*row));
}

double DumpReader::share_read() const {
  return 1.0 - static_cast<double>(rest_.size()) / static_cast<double>(file_.text().size());
}

Expected<SampleBlock> DumpReader::read(std::size_t samples) {
  std::vector<Row> rows;
  while (rows.size() < samples) {
    DYNCAL_TRY(auto row, waiting_
                             ? Expected<std::optional<Row>>(std::exchange(waiting_, std::nullopt))
                             : next_row());
    if (!row) {
      break;
    }
    if (!rows.empty() && row->number != rows.back().number + 1) {
      waiting_ = std::move(row);
      break;
    }
    rows.push_back(std::move(*row));
  }
  SampleBlock block;
  block.samples = rows.size();
  if (rows.empty()) {
    return block;
  }
  block.first_sample = rows.front().number;
  for (const Row& row : rows) {
    block.stamps_ns.push_back(row.stamp_ns);
    block.stamp_uncertainty_ns.push_back(row.u_stamp_ns);
  }
  for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
    for (const Row& row : rows) {
      block.values.push_back(row.values[channel]);
    }
  }
  order_.check(block);
  flag_receiver_stamps(block);
  make_regular(block);
  return block;
}

} // namespace dyncal::drivers::files
