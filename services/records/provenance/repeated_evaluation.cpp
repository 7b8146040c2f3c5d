#include "services/records/provenance/repeated_evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/version.hpp"
#include "services/evaluation/outcome_agreement.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/records/exchange/opened_recording.hpp"
#include "services/records/replay/recorded_run.hpp"
#include "services/records/replay/sample_memory.hpp"
#include "services/views/report/result_file.hpp"
#include "services/views/report/result_json.hpp"

namespace dyncal::inline records {
namespace {

constexpr double max_deviation_u = 0.1; // of another version, or of a part of the recording
constexpr std::int64_t max_instant_difference_ns = 10'000'000'000;

using Json = nlohmann::ordered_json;

tl::unexpected<Error> differs(const StoredResult& kept, const std::string& how) {
  return fail(ErrorCode::no_result,
              fmt::format("{}: is not what the recording of run '{}' gives: {}; the file was "
                          "changed, or the recording is that of another run",
                          kept.file.string(), kept.run, how));
}

// As the bits of a file have it: both ways lose the same members.
Expected<StoredResult> as_read(const RunOutcome& outcome) {
  ByteCount no_progress;
  return result_of_text(json_text(result_json(outcome)), "evaluated again", no_progress);
}

// Whether instants are those of one run, and the rest of both results for comparison: a run that
// was broken off knows more of it than its recording.
bool take_out_instants(StoredResult& kept, StoredResult& again) {
  const auto are_near = [](std::int64_t a_ns, std::int64_t b_ns) {
    return a_ns == 0 || b_ns == 0 || std::abs(a_ns - b_ns) <= max_instant_difference_ns;
  };
  bool near = are_near(parse_utc_text(kept.began_utc), parse_utc_text(again.began_utc)) &&
              are_near(parse_utc_text(kept.ended_utc), parse_utc_text(again.ended_utc));
  for (std::size_t i = 0; i < std::min(kept.pauses.size(), again.pauses.size()); ++i) {
    near = near && are_near(kept.pauses[i].began_utc_ns, again.pauses[i].began_utc_ns) &&
           are_near(kept.pauses[i].ended_utc_ns, again.pauses[i].ended_utc_ns);
  }
  const bool is_broken_off = kept.interrupted || !kept.problem.empty();
  for (StoredResult* result : {&kept, &again}) {
    for (RunPause& pause : result->pauses) {
      pause.began_utc_ns = pause.ended_utc_ns = 0;
    }
    if (is_broken_off) {
      result->interrupted = false;
      result->problem.clear();
    }
  }
  return near;
}

// What another version cannot give otherwise either.
constexpr std::array facts{"bench", "run", "method", "planned_steps", "sources", "roles", "recipe"};

// Without what depends on who evaluates and when: statistics of a clock end where somebody stopped
// to listen.
Json comparable_json(const StoredResult& result, bool is_same_version) {
  StoredResult evaluated = result;
  static_cast<RunStatements&>(evaluated) = {};
  Json json = result_json(evaluated);
  for (const char* member :
       {"began_utc", "ended_utc", "software", "analysis", "dds", "sample_clock"}) {
    json.erase(member);
  }
  if (is_same_version) {
    return json;
  }
  Json part = Json::object();
  for (const char* member : facts) {
    part[member] = json.value(member, Json());
  }
  return part;
}

std::string text_at(const Json& json, const Json::json_pointer& place) {
  constexpr std::size_t max_text = 60;
  if (!json.contains(place)) {
    return "nothing";
  }
  const std::string text = json.at(place).dump();
  return text.size() <= max_text ? text : text.substr(0, max_text) + "...";
}

// To the last bit; empty: equal.
std::string first_difference(StoredResult kept, StoredResult again, bool is_same_version) {
  if (!take_out_instants(kept, again)) {
    return fmt::format("it began and ended {} and {} in the file, {} and {} in the recording",
                       kept.began_utc, kept.ended_utc, again.began_utc, again.ended_utc);
  }
  const Json stated = comparable_json(kept, is_same_version);
  const Json repeated = comparable_json(again, is_same_version);
  const Json changes = Json::diff(stated, repeated);
  if (changes.empty()) {
    return "";
  }
  const auto place = Json::json_pointer(changes.front().at("path").get<std::string>());
  return fmt::format("{} is {} in the file and {} by the recording", place.to_string(),
                     text_at(stated, place), text_at(repeated, place));
}

// Null: the recording lacks what it was made of.
const StoredPoint* find_same(const StoredResult& again, const StoredPoint& wanted) {
  const auto found = std::ranges::find_if(
      again.points, [&](const StoredPoint& one) { return gives_again(one, wanted); });
  return found == again.points.end() ? nullptr : &*found;
}

// In u; NaN stands for NaN.
double part_of_u(double difference, double a, double b, const ExpandedUncertainty& of) {
  if (std::isnan(a) && std::isnan(b)) {
    return 0.0;
  }
  return difference == 0.0 ? 0.0 : std::abs(difference) * of.k / of.expanded;
}

// The larger of what |H| and phase deviate by, in u.
template <class Value>
double deviation_of_values_u(const Value& a, const Value& b) {
  const double turn = std::remainder(a.phase_rad - b.phase_rad, 2.0 * std::numbers::pi);
  return std::max(part_of_u(a.magnitude - b.magnitude, a.magnitude, b.magnitude, a.of_magnitude),
                  part_of_u(turn, a.phase_rad, b.phase_rad, a.of_phase));
}

// The same with their U.
template <class Value>
double deviation_u(const Value& a, const Value& b) {
  const auto part_of_expanded = [](double value_a, double value_b, const ExpandedUncertainty& of_a,
                                   const ExpandedUncertainty& of_b) {
    return part_of_u(of_a.expanded - of_b.expanded, value_a, value_b, of_a);
  };
  return std::max({deviation_of_values_u(a, b),
                   part_of_expanded(a.magnitude, b.magnitude, a.of_magnitude, b.of_magnitude),
                   part_of_expanded(a.phase_rad, b.phase_rad, a.of_phase, b.of_phase)});
}

class Comparison {
public:
  Comparison(const StoredResult& kept, const StoredResult& again, bool is_same_version)
      : kept_(kept), again_(again) {
    found_.is_same_version = is_same_version;
    for (const StoredPoint& point : kept_.points) {
      found_.values += point.valid ? 1 : 0;
      const bool is_missing =
          point.valid && has_values_of(point.channel) && find_same(again_, point) == nullptr;
      found_.missing += is_missing ? 1 : 0;
    }
    // The clocks are known from what is there of them, which moves last bits of earlier steps.
    allowed_u_ = is_same_version && found_.missing == 0 ? 0.0 : max_deviation_u;
  }

  void compare_points() {
    for (const StoredPoint& point : kept_.points) {
      if (!point.valid) {
        continue;
      }
      if (!has_values_of(point.channel)) {
        differ(fmt::format("it knows no channel {}", point.channel));
      } else if (const StoredPoint* same = find_same(again_, point)) {
        // What all steps show goes into each U: it is the same only where all are there.
        note(found_.missing == 0 ? deviation_u(point, *same) : deviation_of_values_u(point, *same),
             point.channel, point.frequency_text_hz, point.magnitude, same->magnitude);
      }
    }
  }

  void compare_means() {
    for (const StoredValue& value : kept_.values) {
      const auto same = std::ranges::find_if(again_.values, [&](const StoredValue& one) {
        return identity_of(one) == identity_of(value);
      });
      if (same == again_.values.end()) {
        note(std::numeric_limits<double>::infinity(), value.channel, value.frequency_text_hz,
             value.magnitude, std::numeric_limits<double>::quiet_NaN());
      } else {
        note(deviation_u(value, *same), value.channel, value.frequency_text_hz, value.magnitude,
             same->magnitude);
        note_flags(value.flag_names, same->flag_names,
                   value.channel + " at " + value.frequency_text_hz + " Hz");
      }
    }
    for (const StoredDelay& one : kept_.group_delays) {
      compare_delay(one);
    }
  }

  // What casts doubt on values, and stands in the file no more, may be why nobody doubts them.
  void compare_doubts() {
    for (const StoredPoint& point : kept_.points) {
      if (const StoredPoint* same = find_same(again_, point)) {
        note_flags(point.flag_names, same->flag_names,
                   fmt::format("{}, step {}", point.channel, point.step));
      }
    }
    for (const StoredChannel& again : again_.channels) {
      const auto kept = std::ranges::find(kept_.channels, again.channel, &StoredChannel::channel);
      if (kept == kept_.channels.end()) {
        differ(fmt::format("channel {} is not in the file", again.channel));
        continue;
      }
      note_flags(kept->flag_names, again.flag_names, again.channel);
      note_closures(*kept, again);
    }
  }

  [[nodiscard]] const RepeatedEvaluation& found() const { return found_; }
  [[nodiscard]] const std::string& difference() const { return difference_; }

private:
  // Or of none: then it is cut.
  [[nodiscard]] bool has_values_of(const std::string& channel) const {
    const auto has = [&](const StoredPoint& one) { return one.valid && one.channel == channel; };
    return std::ranges::any_of(again_.points, has) ||
           std::ranges::none_of(again_.points, &StoredPoint::valid);
  }

  // A deviation that is no number is beyond every limit.
  void note(double by_u, const std::string& channel, const std::string& frequency, double kept,
            double again) {
    if (by_u <= allowed_u_) {
      found_.largest_deviation_u = std::max(found_.largest_deviation_u, by_u);
    } else {
      differ(fmt::format("{} at {} Hz: |H| is {:.6g} in the file and {:.6g} by the recording; "
                         "value or U differ by {:.2g} u",
                         channel, frequency, kept, again, by_u));
    }
  }

  void compare_delay(const StoredDelay& kept) {
    const analysis::GroupDelay* again = again_.group_delay_of(kept.channel);
    const double u_s = kept.delay.u_delay_s();
    const bool is_same =
        again != nullptr &&
        (again->delay_s == kept.delay.delay_s ||
         std::abs(again->delay_s - kept.delay.delay_s) <= allowed_u_ * u_s) &&
        (again->u_delay_s() == u_s || std::abs(again->u_delay_s() - u_s) <= allowed_u_ * u_s);
    if (!is_same) {
      differ(fmt::format("{}: the group delay is another by the recording", kept.channel));
    }
  }

  void note_flags(const std::vector<std::string>& kept, const std::vector<std::string>& again,
                  const std::string& where) {
    for (const std::string& flag : again) {
      if (std::ranges::find(kept, flag) == kept.end()) {
        differ(fmt::format("{} has the flag {} by the recording", where, flag));
      }
    }
  }

  void note_closures(const StoredChannel& kept, const StoredChannel& again) {
    for (const Closure& open : again.closures) {
      const bool is_known = open.verdict != Verdict::open ||
                            std::ranges::any_of(kept.closures, [&](const Closure& one) {
                              return one.kind == open.kind && one.subject == open.subject &&
                                     one.verdict == open.verdict;
                            });
      if (!is_known) {
        differ(fmt::format("{}: a closure is open by the recording: {}", again.channel,
                           open.sentence));
      }
    }
  }

  void differ(std::string how) {
    if (difference_.empty()) {
      difference_ = std::move(how);
    }
  }

  const StoredResult& kept_;
  const StoredResult& again_;
  double allowed_u_ = 0.0;
  RepeatedEvaluation found_;
  std::string difference_;
};

} // namespace

Expected<RepeatedEvaluation> hold_against(const StoredResult& kept, const StoredResult& again) {
  const bool is_same_version = kept.analysis_software == again.analysis_software;
  if (kept.recipe_sha256 != again.recipe_sha256) {
    return differs(kept, "it was evaluated by another recipe than the recorded one");
  }
  Comparison comparison(kept, again, is_same_version);
  comparison.compare_points();
  if (comparison.found().missing == comparison.found().values) {
    return comparison.found(); // a recording that was cut may lack descriptions, too
  }
  const bool is_whole = comparison.found().missing == 0;
  if (is_whole) {
    comparison.compare_means();
    comparison.compare_doubts();
  }
  if (!comparison.difference().empty() && !is_same_version) {
    return fail(ErrorCode::no_result,
                fmt::format("{}: this version evaluates the recording otherwise than {}: {}; "
                            "analyse it anew: 'dyncal analyse RUN --output NEW.json'",
                            kept.file.string(), kept.analysis_software, comparison.difference()));
  }
  if (!comparison.difference().empty()) {
    return differs(kept, comparison.difference());
  }
  const std::string how = first_difference(kept, again, is_same_version && is_whole);
  if (!how.empty()) {
    return differs(kept, how);
  }
  return comparison.found();
}

Expected<RepeatedEvaluation> repeat_evaluation(const StoredResult& result,
                                               const std::filesystem::path& recording,
                                               const SharedWorkCount& count,
                                               const std::stop_token& stop) {
  keep_memory_for_samples();
  DYNCAL_TRY(auto opened, open_recording(recording, count, stop));
  auto evaluated = evaluate_recording(
      opened.reader, {.run = result.run, .recipe = {}, .count = count, .whole_or_none = true},
      stop);
  if (!evaluated && evaluated.error().code == ErrorCode::bad_argument) {
    return differs(result, evaluated.error().message); // it has other runs
  }
  DYNCAL_TRY(evaluated);
  evaluated->outcome.analysis_software = software_version(); // in place of the live one's
  DYNCAL_TRY(const auto again, as_read(evaluated->outcome));
  return hold_against(result, again);
}

} // namespace dyncal::inline records
