#include "services/views/lab_file/laboratory_file.hpp"

#include <fmt/core.h>

#include "services/base/whole_file.hpp"
#include "services/bench/file/calibrated_device.hpp"
#include "services/views/lab_file/table_file.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::uintmax_t max_file_bytes = 1U << 20U;

Person read_person(TomlTable& table) {
  return {.name = required_line(table, "name"),
          .role = line_of(table, "role"),
          .main_signer = table.yes_no("main_signer", false)};
}

ReferenceStandard read_reference(TomlTable& table) {
  ReferenceStandard reference = read_reference_standard(table);
  const CalibratedDevice& device = reference.devices.front();
  const std::pair<const char*, const std::string&> needed[] = {
      {"serial", device.serial},
      {"certificate", device.certificate},
      {"issued_by", device.issued_by},
      {"traceability", reference.traceability}};
  for (const auto& [key, value] : needed) {
    if (value.empty()) {
      table.refuse(key, "is missing");
    }
  }
  return reference;
}

Letterhead read_letterhead(TomlTable& table) {
  return {.title = line_of(table, "title"),
          .lines = lines_of(table, "lines"),
          .remarks = lines_of(table, "remarks"),
          .footer = line_of(table, "footer")};
}

struct ReadTables {
  LaboratoryFile file;
  std::string logo; // as the file names it
};

void read_laboratory(TomlTable& root, ReadTables& read) {
  auto laboratory = root.table("laboratory");
  if (!laboratory) {
    root.refuse("laboratory", "is missing: the table [laboratory] with name, city and country");
    return;
  }
  read.file.laboratory = read_contact(*laboratory);
  read.file.accreditation = line_of(*laboratory, "accreditation");
  read.file.place = line_of(*laboratory, "place");
  read.logo = line_of(*laboratory, "logo");
  laboratory->finish();
}

void read_languages(TomlTable& root, LaboratoryFile& file) {
  const std::string codes = line_of(root, "language");
  if (codes.empty()) {
    return;
  }
  if (auto languages = parse_languages(codes)) {
    file.languages = std::move(*languages);
  } else {
    root.refuse("language", languages.error().message);
  }
}

ReadTables read_tables(const toml::table& parsed, const std::filesystem::path& path,
                       BenchProblems& problems) {
  ReadTables read;
  read.file.path = path;
  TomlTable root(parsed, "", path.string(), problems);
  read_laboratory(root, read);
  read_table(root, "letterhead", read_letterhead, read.file.letterhead);
  read_table(root, "customer", read_contact, read.file.customer);
  read_table(root, "reference", read_reference, read.file.reference);
  read_table(root, "conditions", read_conditions, read.file.conditions);
  read.file.persons = read_tables_of(root, "person", path.string(), problems, read_person);
  read.file.equipment =
      read_tables_of(root, "equipment", path.string(), problems, read_calibrated_device);
  read.file.statements = lines_of(root, "statements");
  read_languages(root, read.file);
  root.finish();
  return read;
}

} // namespace

Expected<LaboratoryFile> parse_laboratory_file(std::string_view text,
                                               const std::filesystem::path& path) {
  DYNCAL_TRY(auto read, parse_tables(text, path, read_tables));
  if (!read.logo.empty()) {
    auto logo = read_picture(path.parent_path() / read.logo);
    if (!logo) {
      return fail(ErrorCode::bad_file, fmt::format("{}: key 'laboratory.logo': {}", path.string(),
                                                   logo.error().message));
    }
    read.file.logo = std::move(*logo);
  }
  return read.file;
}

Expected<LaboratoryFile> read_laboratory_file(const std::filesystem::path& path) {
  DYNCAL_TRY(const auto text, read_whole_file(path, max_file_bytes));
  return parse_laboratory_file(text, path);
}

} // namespace dyncal::inline views
