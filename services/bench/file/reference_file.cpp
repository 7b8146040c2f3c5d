#include "services/bench/file/reference_file.hpp"

#include <optional>

#include <fmt/core.h>
#include <toml++/toml.h>

#include "services/base/whole_file.hpp"
#include "services/bench/file/calibrated_device.hpp"
#include "services/bench/file/measuring_chain.hpp"
#include "services/bench/file/reference_table.hpp"
#include "services/bench/file/toml_lines.hpp"
#include "services/bench/file/toml_text.hpp"
#include "services/contract/digest.hpp"

namespace dyncal::inline bench {
namespace {

constexpr std::uintmax_t max_bytes = 16U << 20U;

// One reference file in TOML, as far as it has been read.
class CertificateReader {
public:
  CertificateReader(std::string name, NamedFiles& files) : name_(std::move(name)), files_(files) {}

  Expected<ReferenceFile> read(const toml::table& parsed, const std::string& path);

private:
  void read_amplifier(TomlTable table);
  void read_channel(TomlTable table);
  std::optional<StatedResponse> read_response(TomlTable table);
  [[nodiscard]] Expected<std::string> rows_of(TomlTable& table);
  void read_chain(TomlTable& root);

  std::string name_;
  NamedFiles& files_;
  ReferenceFile file_;
  std::optional<StatedResponse> transducer_;
  std::optional<StatedResponse> amplifier_;
  std::optional<SensitivityUnit> channel_unit_;
  double channel_sensitivity_ = 1.0;
};

SensitivityUnit read_unit(TomlTable& table, const std::string& otherwise) {
  const std::string text = table.text("unit", otherwise);
  const auto unit = parse_sensitivity_unit(text);
  if (!unit) {
    table.refuse("unit", fmt::format("is \"{}\" but must be \"1\" or output/input, for example "
                                     "\"mV/(m/s^2)\"; known are {}",
                                     text, known_sensitivity_units()));
  }
  return unit.value_or(SensitivityUnit{1.0, "1", "1"});
}

Expected<std::string> CertificateReader::rows_of(TomlTable& table) {
  if (table.has("rows") == table.has("file")) {
    table.refuse("rows", "or 'file' must be there, one of them: the table of the certificate");
  }
  if (!table.has("file")) {
    return table.text("rows");
  }
  const std::filesystem::path folder = std::filesystem::path(name_).parent_path();
  return read_whole_file(files_.resolve((folder / table.required_text("file")).string()),
                         max_bytes);
}

std::optional<StatedResponse> CertificateReader::read_response(TomlTable table) {
  const SensitivityUnit unit = read_unit(table, "1");
  ReferenceTableSettings settings{.is_ratio = unit.is_one()};
  settings.phase_is_lag = table.one_of("phase_sign", {"lead", "lag"}, "lead") == "lag";
  settings.coverage_factor = table.optional_number("k", "coverage factor");
  if (settings.coverage_factor && !(*settings.coverage_factor >= 1.0)) {
    table.refuse("k", "is a coverage factor and must be at least 1");
  }
  for (const std::string& note : lines_of(table, "notes")) {
    file_.notes.push_back(note);
  }
  const auto rows = rows_of(table);
  const std::string key = table.has("file") ? "file" : "rows";
  std::optional<StatedResponse> response;
  if (!rows) {
    table.refuse(key, "names " + rows.error().message);
  } else if (auto read = parse_reference_table(*rows, key, settings)) {
    file_.phase_in_rad |= read->phase_in_rad;
    response = StatedResponse{unit, std::move(read->points)};
  } else if (!table.refused(key)) {
    table.refuse(key, "has a table that cannot be read: " + read.error().message);
  }
  table.finish();
  return response;
}

void CertificateReader::read_amplifier(TomlTable table) {
  file_.standard.devices.push_back(read_calibrated_device(table));
  if (auto response = table.table("response")) {
    amplifier_ = read_response(std::move(*response));
  } else {
    table.refuse("response", "is missing: the gain of the amplifier over frequency");
  }
  table.finish();
}

void CertificateReader::read_channel(TomlTable table) {
  channel_unit_ = read_unit(table, "");
  channel_sensitivity_ = table.number("sensitivity", 0.0, "see its unit");
  if (!(channel_sensitivity_ > 0.0)) {
    table.refuse("sensitivity", "must be there and above 0: what the voltage is divided by");
  }
  file_.channel_unit = fmt::format("{} {}", channel_sensitivity_, table.text("unit"));
  table.finish();
}

// Whether everything that turns a sensitivity into what the channel reads is there.
void CertificateReader::read_chain(TomlTable& root) {
  if (auto response = root.table("response")) {
    transducer_ = read_response(std::move(*response));
  }
  if (auto amplifier = root.table("amplifier")) {
    read_amplifier(std::move(*amplifier));
  }
  if (auto channel = root.table("channel")) {
    read_channel(std::move(*channel));
  }
  const bool is_sensitivity = transducer_ && !transducer_->unit.is_one();
  if (is_sensitivity && !channel_unit_) {
    root.refuse("channel", "is missing: sensitivity and unit that the reference's system divides "
                           "its voltage by, to read what the response is the sensitivity to");
  }
  if (transducer_ && !is_sensitivity && (channel_unit_ || amplifier_)) {
    root.refuse(channel_unit_ ? "channel" : "amplifier",
                "is given, but the response has unit \"1\": it is that of the whole chain");
  }
}

Expected<ReferenceFile> CertificateReader::read(const toml::table& parsed,
                                                const std::string& path) {
  BenchProblems problems;
  TomlTable root(parsed, "", path, problems);
  if (auto reference = root.table("reference")) {
    file_.standard = read_reference_standard(*reference);
    reference->finish();
  } else {
    root.refuse("reference", "is missing: the table [reference] with name and serial");
  }
  read_chain(root);
  root.finish();
  if (!problems.empty()) {
    return fail(ErrorCode::bad_file, problems.front().text());
  }
  if (transducer_ && channel_unit_) {
    auto response = response_of(
        {std::move(*transducer_), std::move(amplifier_), *channel_unit_, channel_sensitivity_});
    if (!response) {
      return fail(ErrorCode::bad_file, fmt::format("{}: {}", path, response.error().message));
    }
    file_.response = std::move(*response);
  } else if (transducer_) {
    file_.response = std::move(transducer_->points);
  }
  return std::move(file_);
}

} // namespace

Expected<ReferenceFile> read_reference_file(const std::string& name, NamedFiles& files) {
  const std::filesystem::path path = files.resolve(name);
  DYNCAL_TRY(const auto text, read_whole_file(path, max_bytes));
  if (path.extension() == ".xml") {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: is a digital certificate; make a reference file of it: dyncal "
                            "import-reference {} --output reference.toml",
                            path.string(), path.string()));
  }
  if (path.extension() != ".toml") {
    DYNCAL_TRY(auto table, parse_reference_table(text, path.string()));
    return ReferenceFile{std::move(table.points), {}, {}, table.phase_in_rad};
  }
  return parse_reference_file(text, name, files);
}

Expected<ReferenceFile> parse_reference_file(std::string_view text, const std::string& name,
                                             NamedFiles& files) {
  const std::filesystem::path path = files.resolve(name);
  const auto parsed = parse_toml(text, path);
  if (!parsed) {
    return fail(ErrorCode::bad_file, parsed.error().text());
  }
  DYNCAL_TRY(auto file, CertificateReader(name, files).read(*parsed, path.string()));
  file.standard.file = name;
  file.standard.file_sha256 = sha256_hex(text);
  return file;
}

} // namespace dyncal::inline bench
