#include "services/views/certificate/reference_certificate.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/toml_string.hpp"
#include "services/base/whole_file.hpp"
#include "services/contract/reference_standard.hpp"
#include "services/views/certificate/dcc_tables.hpp"
#include "services/views/certificate/xml_document.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::uintmax_t max_bytes = 64U << 20U;

std::optional<XmlElement> found(const XmlElement& element,
                                std::initializer_list<std::string_view> path) {
  std::optional<XmlElement> at = element;
  for (const std::string_view name : path) {
    at = at ? at->child(name) : at;
  }
  return at;
}

std::string text_at(const XmlElement& element, std::initializer_list<std::string_view> path) {
  const auto at = found(element, path);
  return at ? english_text(*at) : "";
}

// The value of the identification whose type says what it is, else of the first one.
std::string identification(const std::optional<XmlElement>& list,
                           const std::vector<std::string_view>& types) {
  if (!list) {
    return "";
  }
  const std::vector<XmlElement> all = list->children("identification");
  for (const std::string_view type : types) {
    for (const XmlElement& one : all) {
      if (one.attribute("refType").find(type) != std::string::npos) {
        return text_at(one, {"value"});
      }
    }
  }
  return all.empty() ? "" : text_at(all.front(), {"value"});
}

CalibratedDevice device_of(const XmlElement& certificate) {
  CalibratedDevice device;
  const auto data = found(certificate, {"administrativeData"});
  const auto item = data ? found(*data, {"items", "item"}) : std::nullopt;
  if (item) {
    device.name = text_at(*item, {"name"});
    device.manufacturer = text_at(*item, {"manufacturer", "name"});
    device.model = text_at(*item, {"model"});
    device.serial = identification(item->child("identifications"), {"serialNo", "serialNumber"});
  }
  if (const auto core = data ? data->child("coreData") : std::nullopt) {
    device.certificate = identification(
        core->child("identifications"),
        {"kalibrierzeichen", "alibrationMark", "ertificateNumber", "ertificateIdentification"});
    if (device.certificate.empty()) {
      device.certificate = text_at(*core, {"uniqueIdentifier"});
    }
    device.issued = text_at(*core, {"issueDate"});
    if (device.issued.empty()) {
      device.issued = text_at(*core, {"endPerformanceDate"});
    }
  }
  if (data) {
    device.issued_by = text_at(*data, {"calibrationLaboratory", "contact", "name"});
  }
  return device;
}

// As people write it; some certificates leave out that the second is below the line as well.
std::string sensitivity_unit(const std::string& d_si) {
  using Pair = std::pair<std::string_view, std::string_view>;
  static constexpr std::array<Pair, 6> outputs{{{R"(\pico\coulomb)", "pC"},
                                                {R"(\nano\coulomb)", "nC"},
                                                {R"(\coulomb)", "C"},
                                                {R"(\milli\volt)", "mV"},
                                                {R"(\micro\volt)", "uV"},
                                                {R"(\volt)", "V"}}};
  static constexpr std::array<Pair, 7> inputs{{{R"(\per\metre\second\tothe{-2})", "(m/s^2)"},
                                               {R"(\per\metre\second\tothe{2})", "(m/s^2)"},
                                               {R"(\per\metre\per\second\tothe{-2})", "(m/s^2)"},
                                               {R"(\metre\tothe{-1}\second\tothe{2})", "(m/s^2)"},
                                               {R"(\second\tothe{2}\per\metre)", "(m/s^2)"},
                                               {R"(\metre\tothe{-1}\second)", "(m/s)"},
                                               {R"(\second\per\metre)", "(m/s)"}}};
  if (d_si == R"(\one)") {
    return "1";
  }
  for (const auto& [output, text] : outputs) {
    const auto input = std::ranges::find(
        inputs, d_si.starts_with(output) ? std::string_view(d_si).substr(output.size()) : "",
        &Pair::first);
    if (input != inputs.end()) {
      return fmt::format("{}/{}", text, input->second);
    }
  }
  return "";
}

Expected<DccTable> chosen_table(const std::vector<DccTable>& tables, const std::string& name,
                                const std::string& file) {
  std::vector<std::string> names;
  names.reserve(tables.size());
  for (const DccTable& table : tables) {
    names.push_back(fmt::format("\"{}\"", table.name));
  }
  const auto chosen = name.empty() && tables.size() == 1
                          ? tables.begin()
                          : std::ranges::find(tables, name, &DccTable::name);
  if (chosen != tables.end()) {
    return *chosen;
  }
  return fail(
      ErrorCode::bad_file,
      tables.empty()
          ? fmt::format("{}: has no table of magnitudes over frequency; write the values of "
                        "the certificate into a reference file by hand",
                        file)
          : fmt::format("{}: has several tables; choose one with --table: {}", file,
                        fmt::join(names, ", ")));
}

// What a column is taken for by its type may be in another unit: 1 kHz is not 1 Hz.
Expected<void> check_units(const DccTable& table, const std::string& file) {
  const bool is_angle =
      !table.phase || table.phase->unit == R"(\degree)" || table.phase->unit == R"(\radian)";
  if (table.frequency.unit == R"(\hertz)" && is_angle) {
    return {};
  }
  return fail(ErrorCode::bad_file,
              fmt::format("{}: {} is in '{}', and must be in {}; write the values into a reference "
                          "file by hand",
                          file, is_angle ? "frequency" : "the phase",
                          is_angle ? table.frequency.unit : table.phase->unit,
                          is_angle ? R"(\hertz)" : R"(\degree or \radian)"));
}

struct Rows {
  std::vector<std::string> heads;
  std::vector<const std::vector<std::string>*> columns;
  std::vector<std::string> coverage; // where it is a column
};

// With a column k where U is stated; where magnitude and phase do not have the same, u of the phase
// is worked out.
void add_measured(const DccColumn& column, const std::string& value, const std::string& u,
                  Rows& rows) {
  rows.heads.push_back(value);
  rows.columns.push_back(&column.values);
  if (!column.uncertainties.empty()) {
    rows.heads.push_back((column.coverage_factors.empty() ? "u_" : "U_") + u);
    rows.columns.push_back(&column.uncertainties);
  }
}

double number_of(const std::string& text) {
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

DccColumn with_standard_uncertainty(DccColumn column) {
  for (std::size_t i = 0; i < column.coverage_factors.size(); ++i) {
    column.uncertainties[i] = fmt::format("{}", number_of(column.uncertainties[i]) /
                                                    number_of(column.coverage_factors[i]));
  }
  column.coverage_factors.clear();
  return column;
}

std::string rows_of(const DccTable& table) {
  Rows rows{{"frequency_hz"}, {&table.frequency.values}, table.magnitude.coverage_factors};
  if (table.level) {
    rows.heads.emplace_back("level_m_s2");
    rows.columns.push_back(&table.level->values);
  }
  add_measured(table.magnitude, "magnitude", "magnitude", rows);
  DccColumn phase = table.phase.value_or(DccColumn());
  if (table.phase) {
    if (!rows.coverage.empty() && phase.coverage_factors != rows.coverage) {
      phase = with_standard_uncertainty(std::move(phase));
    } else if (rows.coverage.empty()) {
      rows.coverage = phase.coverage_factors;
    }
    const std::string unit = phase.unit == R"(\radian)" ? "phase_rad" : "phase_deg";
    add_measured(phase, unit, unit, rows);
  }
  if (!rows.coverage.empty()) {
    rows.heads.emplace_back("k");
    rows.columns.push_back(&rows.coverage);
  }
  std::string text = fmt::format("{}\n", fmt::join(rows.heads, ", "));
  for (std::size_t i = 0; i < table.frequency.values.size(); ++i) {
    std::vector<std::string> fields;
    for (const auto* column : rows.columns) {
      fields.push_back(column->at(i));
    }
    text += fmt::format("{}\n", fmt::join(fields, ", "));
  }
  return text;
}

std::string head_of(const CalibratedDevice& device, const std::string& file) {
  std::string text =
      fmt::format("# Made from {} by 'dyncal import-reference'.\n[reference]\n", file);
  const auto add = [&](const char* key, const std::string& value) {
    text += value.empty() ? "" : fmt::format("{} = {}\n", key, toml_string(value));
  };
  add("name", device.name.empty() ? "Reference transducer" : device.name);
  add("manufacturer", device.manufacturer);
  add("model", device.model);
  add("serial", device.serial);
  add("certificate", device.certificate);
  add("issued_by", device.issued_by);
  add("issued", device.issued);
  text += "# To be added: how long it may be used, and the sentence for documents.\n"
          "# interval_months = 24\n# traceability = \"...\"\nstandard = \"ISO 16063-21\"\n";
  return text;
}

// What a certificate of the transducer does not know of the chain.
std::string tail_of(const std::string& unit) {
  std::string text;
  if (unit.starts_with("C/") || unit.starts_with("nC/") || unit.starts_with("pC/")) {
    text += R"toml(
# To be added: the charge amplifier by its certificate.
# [amplifier]
# name = "Charge amplifier"
# serial = "..."
# [amplifier.response]
# unit = "mV/pC"
# k = 2
# rows = """
# frequency_hz, magnitude, phase_deg, U_magnitude_percent, U_phase_deg
# """
)toml";
  }
  if (unit != "1") {
    text += R"toml(
# To be added: the sensitivity that the analogue system divides its voltage by.
# [channel]
# unit = "mV/(m/s^2)"
# sensitivity = 0.1
)toml";
  }
  return text;
}

} // namespace

Expected<std::string> reference_file_of(const std::filesystem::path& certificate,
                                        const std::string& table) {
  DYNCAL_TRY(const auto xml, read_whole_file(certificate, max_bytes));
  DYNCAL_TRY(const auto document, XmlDocument::parse(xml, certificate.string()));
  const XmlElement root = document.root();
  if (!root.is("digitalCalibrationCertificate", dcc_namespace)) {
    return fail(ErrorCode::bad_file, fmt::format("{}: is no digital calibration certificate (DCC)",
                                                 certificate.string()));
  }
  DYNCAL_TRY(const auto chosen, chosen_table(response_tables(root), table, certificate.string()));
  DYNCAL_TRY(check_units(chosen, certificate.string()));
  const std::string unit = sensitivity_unit(chosen.magnitude.unit);
  if (unit.empty()) {
    return fail(ErrorCode::bad_file,
                fmt::format("{}: the unit of the magnitudes, '{}', is not that of a sensitivity; "
                            "write the values into a reference file by hand",
                            certificate.string(), chosen.magnitude.unit));
  }
  std::vector<std::string> notes;
  for (const std::string& comment : chosen.comments) {
    notes.push_back(toml_string(comment));
  }
  return head_of(device_of(root), certificate.filename().string()) +
         fmt::format(
             "\n[response]\nunit = {}\n# Of the output against what is measured (ISO 2041); "
             "if the certificate means a delay: \"lag\".\nphase_sign = \"lead\"\n",
             toml_string(unit)) +
         (notes.empty() ? "" : fmt::format("notes = [{}]\n", fmt::join(notes, ", "))) +
         fmt::format("rows = \"\"\"\n{}\"\"\"\n", rows_of(chosen)) + tail_of(unit);
}

} // namespace dyncal::inline views
