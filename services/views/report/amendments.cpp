#include "services/views/report/amendments.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/parsed_number.hpp"

namespace dyncal::inline views {
namespace {

constexpr const char* serial_key = "serial";
constexpr const char* model_key = "model";

// Conditions, each with its expanded uncertainty.
const std::set<std::string>& number_keys() {
  static const std::set<std::string> keys{"temperature_degc", "U_temperature_k",
                                          "humidity_percent", "U_humidity_percent",
                                          "pressure_hpa",     "U_pressure_hpa"};
  return keys;
}

// Of the channels under calibration.
std::set<std::string> sources_of(const StoredResult& result) {
  std::set<std::string> sources;
  for (const StoredChannel& channel : result.channels) {
    sources.insert(channel.channel.substr(0, channel.channel.find('/')));
  }
  return sources;
}

tl::unexpected<Error> refuse(const std::string& sentence) {
  return fail(ErrorCode::bad_argument, sentence);
}

// "serial" of the only source is "dau/serial".
Expected<std::string> whole_key(const StoredResult& result, const std::string& typed) {
  const std::size_t slash = typed.find('/');
  const std::string key = slash == std::string::npos ? typed : typed.substr(slash + 1);
  const bool is_of_source = key == serial_key || key == model_key;
  if (std::ranges::find(amendable_keys(), key) == amendable_keys().end() ||
      (slash != std::string::npos && !is_of_source)) {
    return refuse(
        fmt::format("'{}' cannot be amended; these can: {}. What was measured is measured "
                    "again, or evaluated by another recipe",
                    typed, fmt::join(amendable_keys(), ", ")));
  }
  if (!is_of_source) {
    return key;
  }
  const std::set<std::string> sources = sources_of(result);
  const std::string source = slash == std::string::npos ? "" : typed.substr(0, slash);
  if (source.empty() && sources.size() != 1) {
    return refuse(fmt::format("the run has several sources ({}): write SOURCE/{}=...",
                              fmt::join(sources, ", "), key));
  }
  const std::string name = source.empty() ? *sources.begin() : source;
  if (std::ranges::find(result.sources, name, &RunSource::source) == result.sources.end()) {
    return refuse(fmt::format("the run has no source '{}'", name));
  }
  return name + "/" + key;
}

// As the run has it now, with its journal; empty: it does not say.
std::string present_value(const StoredResult& result, const std::string& key) {
  if (const auto value = amended(result.journal, key)) {
    return *value;
  }
  if (key == "operator") {
    return result.conducted_by ? name_of(*result.conducted_by) : "";
  }
  if (key == "comment") {
    return result.comment;
  }
  const std::size_t slash = key.find('/');
  const auto source = std::ranges::find(result.sources, key.substr(0, slash), &RunSource::source);
  if (slash == std::string::npos || source == result.sources.end()) {
    return "";
  }
  return key.substr(slash + 1) == serial_key ? source->description.serial
                                             : source->description.device;
}

} // namespace

const std::vector<std::string>& amendable_keys() {
  static const std::vector<std::string> keys{serial_key,         model_key,
                                             "manufacturer",     "owner_identification",
                                             "received",         "condition",
                                             "customer",         "operator",
                                             "comment",          "positive_direction",
                                             "mounting",         "orientation",
                                             "temperature_degc", "U_temperature_k",
                                             "humidity_percent", "U_humidity_percent",
                                             "pressure_hpa",     "U_pressure_hpa"};
  return keys;
}

Expected<AmendedValue> amended_value(const StoredResult& result, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    return refuse(fmt::format("'{}' must be KEY=VALUE", assignment));
  }
  AmendedValue change;
  DYNCAL_TRY(change.key, whole_key(result, assignment.substr(0, equals)));
  change.after = assignment.substr(equals + 1);
  if (change.after.empty()) {
    return refuse(fmt::format("'{}' has no value", assignment));
  }
  if (number_keys().contains(change.key) && !parsed_number<double>(change.after)) {
    return refuse(fmt::format("'{}' is no number with a decimal point", assignment));
  }
  change.before = present_value(result, change.key);
  if (change.before == change.after) {
    return refuse(fmt::format("{} is '{}' already", change.key, change.after));
  }
  return change;
}

std::optional<std::string> amended(const std::vector<JournalEntry>& journal,
                                   const std::string& key) {
  std::optional<std::string> value;
  for (const JournalEntry& entry : journal) {
    for (const AmendedValue& change : entry.changes) {
      value = change.key == key ? change.after : value;
    }
  }
  return value;
}

void amend_sources(const std::vector<JournalEntry>& journal, std::vector<RunSource>& sources) {
  for (RunSource& source : sources) {
    drivers::SourceDescription& description = source.description;
    description.serial =
        amended(journal, source.source + "/" + serial_key).value_or(description.serial);
    description.device =
        amended(journal, source.source + "/" + model_key).value_or(description.device);
  }
}

void add_journal(std::vector<JournalEntry> journal, StoredResult& result) {
  sort_journal(journal);
  amend_sources(journal, result.sources);
  if (const auto name = amended(journal, "operator")) {
    result.conducted_by = ActingPerson{*name, result.conducted_by ? result.conducted_by->user : "",
                                       result.conducted_by ? result.conducted_by->host : ""};
  }
  result.comment = amended(journal, "comment").value_or(result.comment);
  result.journal = std::move(journal);
}

std::vector<std::string> amendment_sentences(const std::vector<JournalEntry>& journal,
                                             Language language) {
  std::vector<std::string> all;
  for (const JournalEntry& entry : journal) {
    std::ranges::move(amendment_sentences(entry, language), std::back_inserter(all));
  }
  return all;
}

} // namespace dyncal::inline views
