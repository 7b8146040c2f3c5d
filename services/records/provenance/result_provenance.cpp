#include "services/records/provenance/result_provenance.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/records/exchange/opened_recording.hpp"
#include "services/records/provenance/repeated_evaluation.hpp"
#include "services/records/store/store.hpp"
#include "services/views/language/objection_sentences.hpp"
#include "services/views/language/statement_sentences.hpp"
#include "services/views/report/amendments.hpp"
#include "services/views/report/mean_check.hpp"

namespace dyncal::inline records {
namespace {

constexpr std::size_t shown_of_hash = 12;

std::string utc_in(Language language, const std::string& utc) {
  return language == Language::english ? utc : instant_text(language, utc);
}

// Empty: nothing is known of it there.
Expected<TranslatedText> said_by_store(const StoredResult& result, const std::string& place) {
  std::error_code unknown;
  if (place.empty() || (!is_server(place) && !std::filesystem::exists(place, unknown))) {
    return TranslatedText();
  }
  DYNCAL_TRY(const auto store, Store::open_existing(place));
  DYNCAL_TRY(const auto kept, store->hash_of(result));
  if (!kept) {
    return TranslatedText();
  }
  if (kept->sha256 != result.sha256) {
    return fail(ErrorCode::no_result,
                fmt::format("{}: is not the result that the store has of run '{}': its SHA-256 is "
                            "{}..., that in the store {}...; it was changed after it was kept: "
                            "take the run folder from a back-up",
                            result.file.string(), result.run,
                            result.sha256.substr(0, shown_of_hash),
                            kept->sha256.substr(0, shown_of_hash)));
  }
  return in_all_languages([&](Language language) {
    return sentences::kept_in_store(language, utc_in(language, kept->since_utc),
                                    result.sha256.substr(0, shown_of_hash));
  });
}

// Of the run folder; of a result file, those that the store has. Whoever can write the folder can
// write a line: the store is what proves an amendment.
Expected<std::vector<JournalEntry>> held_journal(const std::filesystem::path& run,
                                                 const std::string& place, HeldResult& held) {
  std::error_code unknown;
  const StoredResult& result = held.result;
  std::vector<JournalEntry> kept;
  if (!place.empty() && (is_server(place) || std::filesystem::exists(place, unknown))) {
    DYNCAL_TRY(const auto store, Store::open_existing(place));
    DYNCAL_TRY(kept, store->entries_of(result.bench, result.run));
  }
  if (!std::filesystem::is_directory(run, unknown)) {
    return kept;
  }
  DYNCAL_TRY(auto journal, read_journal(run));
  const auto is_in = [](const std::vector<JournalEntry>& entries, const JournalEntry& wanted) {
    return std::ranges::any_of(entries, [line = line_of(wanted)](const JournalEntry& one) {
      return line_of(one) == line;
    });
  };
  for (const JournalEntry& entry : kept) {
    if (!is_in(journal, entry)) {
      return fail(ErrorCode::no_result,
                  fmt::format("{}: lacks the {} of {} that the store has of run '{}', or has it "
                              "otherwise: it was changed; take it from a back-up",
                              (run / journal_file_name).string(), kind_name(entry.kind), entry.utc,
                              result.run));
    }
  }
  for (const JournalEntry& entry : journal) {
    if (entry.kind == JournalKind::amendment && !is_in(kept, entry)) {
      held.objections.push_back(in_all_languages([&](Language language) {
        return sentences::amendment_not_in_store(language, utc_in(language, entry.utc),
                                                 run.string());
      }));
    }
  }
  return journal;
}

TranslatedText said_of_mountings(const StoredResult& result) {
  std::vector<std::string> runs;
  for (const CombinedRun& one : result.combined) {
    runs.push_back(fmt::format("{} (SHA-256 {}...)", one.run, one.sha256.substr(0, shown_of_hash)));
  }
  return in_all_languages([&](Language language) {
    return sentences::combines_runs(language, runs.size(), fmt::join(runs, ", "));
  });
}

TranslatedText said_of(const RepeatedEvaluation& repeated, const StoredResult& result) {
  if (repeated.is_same_version && repeated.missing == 0) {
    return sentences::same_digits.translated();
  }
  return in_all_languages([&](Language language) {
    const std::string largest =
        decimal(language, fmt::format("{:.2g}", repeated.largest_deviation_u));
    if (repeated.missing > 0) {
      return sentences::same_part(language, repeated.values - repeated.missing, repeated.values,
                                  largest);
    }
    return sentences::by_another_version(language, result.analysis_software,
                                         repeated.largest_deviation_u == 0.0
                                             ? sentences::same_values(language)
                                             : sentences::other_values(language, largest));
  });
}

// A recording that lacks some of the samples speaks for the rest, where the store has the file.
void add_recording(Expected<RepeatedEvaluation> repeated, bool is_kept, HeldResult& held) {
  if (!repeated) {
    held.objections.push_back(in_all_languages([&](Language language) {
      return sentences::not_evaluated_again(
          language, language == Language::english ? ": " + repeated.error().message : "");
    }));
    return;
  }
  if (repeated->missing < repeated->values) {
    held.statements.push_back(said_of(*repeated, held.result));
  }
  if (repeated->missing > 0) {
    TranslatedText lack = in_all_languages([&](Language language) {
      return sentences::recording_lacks(language, repeated->missing, repeated->values);
    });
    (is_kept ? held.statements : held.objections).push_back(std::move(lack));
  }
}

bool ends_it(const Expected<RepeatedEvaluation>& repeated) {
  return !repeated && (repeated.error().code == ErrorCode::no_result ||
                       repeated.error().code == ErrorCode::interrupted);
}

Expected<HeldResult> read_held_file(const std::filesystem::path& run, const std::string& store,
                                    const SharedWorkCount& count, const std::stop_token& stop) {
  HeldResult held;
  DYNCAL_TRY(held.result, read_values(run));
  const StoredResult& result = held.result;
  DYNCAL_TRY(check_means(result));
  DYNCAL_TRY(const auto kept, said_by_store(result, store));
  if (!kept.empty()) {
    held.statements.push_back(kept);
  }
  if (!result.combined.empty()) {
    held.statements.push_back(said_of_mountings(result));
    if (kept.empty()) {
      held.objections.push_back(sentences::combined_not_in_store.translated());
    }
    return held;
  }
  std::error_code unknown;
  if (std::filesystem::is_directory(run, unknown) && is_recording(run)) {
    auto repeated = repeat_evaluation(result, run, count, stop);
    if (ends_it(repeated)) {
      return fail(std::move(repeated.error()));
    }
    add_recording(std::move(repeated), !kept.empty(), held);
  } else if (kept.empty()) {
    held.objections.push_back(in_all_languages([&](Language language) {
      return sentences::nothing_shows(language, result.file.filename().string(),
                                      store.empty() ? "" : " " + without_password(store));
    }));
  } else {
    held.statements.push_back(sentences::no_recording.translated());
  }
  return held;
}

} // namespace

Expected<HeldResult> read_held_result(const std::filesystem::path& run, const std::string& store,
                                      const SharedWorkCount& count, const std::stop_token& stop) {
  DYNCAL_TRY(auto held, read_held_file(run, store, count, stop));
  DYNCAL_TRY(auto journal, held_journal(run, store, held));
  add_journal(std::move(journal), held.result);
  return held;
}

} // namespace dyncal::inline records
