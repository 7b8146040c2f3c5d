#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <optional>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "services/base/output_stream.hpp"
#include "services/base/version.hpp"
#include "services/records/exchange/row_formats.hpp"
#include "services/records/mcap/recording_writer.hpp"
#include "services/records/mcap/text_crc.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::size_t chunk_bytes = std::size_t{1} << 20U;
constexpr std::string_view little_endian_cdr("\x00\x01\x00\x00", 4);

// Letters, digits and single underscores, as names of ROS messages have them; begins with a letter.
std::string identifier(const std::string& text, bool capital) {
  std::string name;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && std::isalnum(byte) != 0) {
      name += static_cast<char>(std::tolower(byte));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') {
    name.pop_back();
  }
  if (name.empty() || std::isalpha(static_cast<unsigned char>(name.front())) == 0) {
    name = "c" + name;
  }
  if (capital) {
    std::erase(name, '_');
    name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
  }
  return name;
}

// Its time column becomes stamp_s, seconds after the source's first sample.
std::string schema_of(const RowTable& table) {
  std::string text;
  std::set<std::string> names;
  for (const RowColumn& column : table.columns()) {
    std::string name = column.name == "t_ns" ? "stamp_s" : identifier(column.name, false);
    while (!names.insert(name).second) {
      name += "x";
    }
    text += fmt::format("float64 {}{}\n", name,
                        column.is_channel && !column.unit.empty() ? "  # " + column.unit : "");
  }
  return text;
}

recording::WriterOptions options_of(const std::vector<RowTable>& tables) {
  recording::WriterOptions options;
  options.library = software_version();
  for (const RowTable& table : tables) {
    const auto id = static_cast<std::uint16_t>(options.channels.size() + 1);
    const std::string& name = table.source().name;
    options.schemas.push_back(
        {id, "dyncal_rows/msg/" + identifier(name, true), "ros2msg", schema_of(table)});
    recording::TextMap about{
        {recording::schema_crc_key, recording::schema_crc(options.schemas.back())}};
    for (const RowColumn& column : table.columns()) {
      if (column.is_channel) {
        about["unit of " + column.name] = column.unit;
      }
    }
    options.channels.push_back({id, id, name, "cdr", std::move(about)});
  }
  return options;
}

// Adds the rows of one table as messages.
class RowWriter {
public:
  RowWriter(recording::RecordingWriter& writer, const recording::Channel& channel,
            const RowTable& table)
      : writer_(writer), channel_(channel),
        is_local_(!table.source().recorded->triggered && table.source().description &&
                  table.source().description->time_base() == wire::TIME_BASE_LOCAL) {}

  [[nodiscard]] Expected<void> add(const Rows& rows) {
    const auto& stamps = std::get<std::vector<std::int64_t>>(rows.columns.front());
    if (!first_ns_) {
      first_ns_ = stamps.front();
    }
    if (std::exchange(session_, rows.session) != rows.session && is_local_) {
      shift_ns_ = rows.received_utc_ns - stamps.back();
    }
    for (std::size_t row = 0; row < rows.count; ++row) {
      std::string data(little_endian_cdr);
      append(data, static_cast<double>(stamps[row] - *first_ns_) * 1e-9);
      for (std::size_t column = 1; column < rows.columns.size(); ++column) {
        std::visit([&](const auto& values) { append(data, static_cast<double>(values[row])); },
                   rows.columns[column]);
      }
      recording::Message message;
      message.channel_id = channel_.id;
      message.sequence = sequence_++;
      message.log_time =
          static_cast<std::uint64_t>(std::max<std::int64_t>(0, stamps[row] + shift_ns_));
      message.publish_time = message.log_time;
      message.data = data;
      chunk_.add(channel_, message);
    }
    return chunk_.records().size() < chunk_bytes ? Expected<void>{} : flush();
  }
  [[nodiscard]] Expected<void> flush() {
    auto written = chunk_.empty() ? Expected<void>{} : writer_.add_chunk(chunk_);
    chunk_ = {};
    return written;
  }

private:
  static void append(std::string& data, double value) {
    std::array<char, sizeof(value)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(value));
    data.append(bytes.data(), bytes.size());
  }

  recording::RecordingWriter& writer_;
  const recording::Channel& channel_;
  bool is_local_;
  recording::Chunk chunk_;
  std::optional<std::int64_t> first_ns_;
  std::optional<std::size_t> session_;
  std::int64_t shift_ns_ = 0;
  std::uint32_t sequence_ = 0;
};

Expected<void> write_rows(const RowExport& wanted, const std::filesystem::path& path) {
  const recording::WriterOptions options = options_of(wanted.tables);
  DYNCAL_TRY(auto writer, recording::RecordingWriter::create(path, options));
  DYNCAL_TRY(writer.add_attachment({0, "contents.json", "application/json", wanted.contents}));
  RowProgress progress(wanted);
  for (std::size_t i = 0; i < wanted.tables.size(); ++i) {
    RowWriter rows(writer, options.channels[i], wanted.tables[i]);
    auto written =
        progress.for_each(wanted.tables[i], [&](const Rows& some) { return rows.add(some); })
            .and_then([&] { return rows.flush(); });
    if (!written) {
      return written;
    }
  }
  return writer.close();
}

} // namespace

Expected<void> export_mcap_rows(const RowExport& wanted) {
  DYNCAL_TRY(check_new_output(wanted.to));
  const std::filesystem::path unfinished = wanted.to.string() + ".part";
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);
  auto done = write_rows(wanted, unfinished).and_then([&] {
    return take_output_name(unfinished, wanted.to);
  });
  if (!done) {
    std::filesystem::remove(unfinished, ignored);
  }
  return done;
}

} // namespace dyncal::inline records
