#include "services/programs/web/journal_answers.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "services/bench/file/named_files.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/programs/web/laboratory_answers.hpp"
#include "services/programs/web/request_router.hpp"
#include "services/records/store/store.hpp"
#include "services/views/report/amendments.hpp"

namespace dyncal::inline programs::web {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t max_journal_bytes = std::size_t{8} * 1024 * 1024;
constexpr std::size_t max_result_bytes = std::size_t{64} * 1024 * 1024;

std::string text_at(const Json& json, const char* name) {
  const auto found = json.find(name);
  return found != json.end() && found->is_string() ? found->get<std::string>() : std::string();
}

Json entry_json(const JournalEntry& entry) {
  constexpr double ns_per_ms = 1e6;
  return {{"utc_ms", static_cast<double>(parse_utc_text(entry.utc)) / ns_per_ms},
          {"kind", kind_name(entry.kind)},
          {"by", name_of(entry.by)},
          {"text", entry.kind == JournalKind::amendment
                       ? fmt::format("{}", fmt::join(amendment_sentences(entry), "; "))
                       : entry.text}};
}

} // namespace

JournalAnswers::Noted JournalAnswers::statements_of(const std::string& run,
                                                    const ServedFile& result) {
  const std::string state = run + " " + result.etag;
  {
    const std::lock_guard lock(mutex_);
    const auto known = results_.find(state);
    if (known != results_.end()) {
      return known->second;
    }
  }
  // Of the members of the file, which may be large, no others are kept.
  const auto keep = [](int depth, Json::parse_event_t event, Json& parsed) {
    return depth != 1 || event != Json::parse_event_t::key || parsed == "conducted_by" ||
           parsed == "comment";
  };
  const Json json = Json::parse(whole_text(result, max_result_bytes).value_or(""), keep, false);
  Noted noted;
  if (json.is_object()) {
    const Json by = json.value("conducted_by", Json::object());
    if (by.is_object() && !by.empty()) {
      const ActingPerson person{text_at(by, "name"), text_at(by, "user"), text_at(by, "host")};
      noted.conducted_by = text_of(person);
    }
    noted.comment = text_at(json, "comment");
  }
  const std::lock_guard lock(mutex_);
  if (results_.size() >= max_results_known) {
    results_.clear();
  }
  results_[state] = noted;
  return noted;
}

Expected<JournalAnswers::Noted> JournalAnswers::of_folder(const std::string& bench,
                                                          const std::string& run) {
  const auto opened = [&](std::string_view name) {
    const auto file = files_.find(bench, run, std::string(name));
    return file ? files_.open(*file) : std::nullopt;
  };
  const auto result = opened(result_file_name);
  const auto journal = opened(journal_file_name);
  Noted noted = result ? statements_of(run, *result) : Noted{};
  if (!journal) {
    return noted;
  }
  const auto text = whole_text(*journal, max_journal_bytes);
  if (!text) {
    return fail(ErrorCode::bad_file,
                fmt::format("{} is too large to be shown here; download it", journal_file_name));
  }
  std::istringstream lines(*text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    DYNCAL_TRY(auto entry,
               journal_entry_of(line, fmt::format("{}:{}", journal_file_name, ++number)));
    noted.entries.push_back(std::move(entry));
  }
  sort_journal(noted.entries);
  return noted;
}

Expected<JournalAnswers::Noted> JournalAnswers::of_store(const std::string& bench,
                                                         const std::string& run) {
  std::error_code unknown;
  if (place_.empty() || (!is_server(place_) && !std::filesystem::exists(place_, unknown))) {
    return Noted{};
  }
  const std::unique_lock lock(store_mutex_, longest_wait);
  if (!lock) {
    return fail(ErrorCode::bad_file, "the store is slow and is still answering others; ask again");
  }
  DYNCAL_TRY(const auto store, Store::open_existing(place_));
  Noted noted;
  DYNCAL_TRY(noted.entries, store->entries_of(bench, run));
  return noted;
}

bool JournalAnswers::answer(const httplib::Request& request, httplib::Response& response) {
  const auto address = bench_address(request.path);
  if (!address || address->part != "journal") {
    return false;
  }
  const std::string asked = request.get_param_value("run");
  const std::string run = cache_.look([&](const network::BusState& laboratory) {
    const network::Run* const found = find_run(laboratory.bench(address->bench), asked);
    return found == nullptr ? std::string() : found->name;
  });
  if (run.empty()) {
    answer_error(404, "not_known", "no such run of this bench was heard of", response);
    return true;
  }
  const bool has_folder = !files_.files_of(address->bench, run).empty();
  const auto noted = has_folder ? of_folder(address->bench, run) : of_store(address->bench, run);
  Json json{{"bench", address->bench}, {"run", run}};
  if (!noted) {
    json["problem"] = noted.error().message;
  }
  const Noted known = noted.value_or(Noted{});
  const std::size_t left_out = known.entries.size() - std::min(known.entries.size(), max_entries);
  json["conducted_by"] = amended(known.entries, "operator").value_or(known.conducted_by);
  json["comment"] = amended(known.entries, "comment").value_or(known.comment);
  json["left_out"] = left_out;
  json["entries"] = Json::array();
  for (std::size_t i = left_out; i < known.entries.size(); ++i) {
    json["entries"].push_back(entry_json(known.entries[i]));
  }
  answer_json(json, response);
  return true;
}

} // namespace dyncal::inline programs::web
