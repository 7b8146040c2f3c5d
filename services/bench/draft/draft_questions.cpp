#include "services/bench/draft/draft_questions.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <istream>
#include <ostream>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "analysis/base/frequency.hpp"
#include "analysis/base/preferred_frequencies.hpp"
#include "drivers/link/address.hpp"
#include "services/base/per_enumerator.hpp"

namespace dyncal::inline bench::bench_draft {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos
             ? std::string()
             : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// Takes an answer, or says what one looks like.
using Take = std::function<std::optional<std::string>(const std::string& answer)>;

class Interview {
public:
  Interview(std::istream& answers, std::ostream& questions)
      : answers_(answers), questions_(questions) {}

  // False once the answers have ended.
  void ask(const std::string& question, const std::string& usual, const Take& take) {
    while (!ended_) {
      questions_ << question << (usual.empty() ? "" : fmt::format(" [{}]", usual)) << ": "
                 << std::flush;
      std::string answer;
      if (!std::getline(answers_, answer)) {
        ended_ = true;
        questions_ << '\n';
        return;
      }
      answer = trimmed(answer);
      const auto problem = take(answer.empty() ? usual : answer);
      if (!problem) {
        return;
      }
      questions_ << "  " << *problem << '\n';
    }
  }

  // A text that is not empty, and that `problem_of` finds nothing wrong with.
  void text(const std::string& question, std::string& value, const NameProblem& problem_of = {}) {
    ask(question, value, [&](const std::string& answer) -> std::optional<std::string> {
      if (answer.empty()) {
        return "write something";
      }
      auto problem = problem_of ? problem_of(answer) : std::nullopt;
      if (!problem) {
        value = answer;
      }
      return problem;
    });
  }

  void address(const std::string& question, std::string& value) {
    text(question, value, [](const std::string& answer) -> std::optional<std::string> {
      const auto parsed = drivers::parse_address(answer);
      return parsed ? std::nullopt : std::optional(parsed.error().message);
    });
  }

  void file(const std::string& question, std::string& value) {
    text(question, value, [](const std::string& answer) -> std::optional<std::string> {
      std::error_code unknown;
      return std::filesystem::is_regular_file(answer, unknown)
                 ? std::nullopt
                 : std::optional(fmt::format("there is no file '{}'", answer));
    });
  }

  // An empty answer is one as well.
  void optional_file(const std::string& question, std::string& value) {
    ask(question, value, [&](const std::string& answer) -> std::optional<std::string> {
      std::error_code unknown;
      if (!answer.empty() && !std::filesystem::is_regular_file(answer, unknown)) {
        return fmt::format("there is no file '{}'", answer);
      }
      value = answer;
      return std::nullopt;
    });
  }

  void positive(const std::string& question, double& value) {
    ask(question, fmt::format("{}", value),
        [&](const std::string& answer) -> std::optional<std::string> {
          double number = 0.0;
          const auto [end, status] =
              std::from_chars(answer.data(), answer.data() + answer.size(), number);
          if (status != std::errc{} || end != answer.data() + answer.size() || !(number > 0.0)) {
            return "write a positive number, for example 2.5";
          }
          value = number;
          return std::nullopt;
        });
  }

  template <class Kind>
  void choice(const std::string& question, Kind& kind) {
    const std::string all = fmt::format("{}", fmt::join(enumerator_texts<Kind>(), ", "));
    ask(fmt::format("{} ({})", question, all), to_string(kind),
        [&](const std::string& answer) -> std::optional<std::string> {
          const auto chosen = parse_enumerator<Kind>(answer);
          kind = chosen.value_or(kind);
          return chosen ? std::nullopt : std::optional("write one of " + all);
        });
  }

  void frequencies(std::vector<std::string>& values) {
    ask("Frequencies in Hz, with blanks between them, or third-octave 10..200",
        fmt::format("{}", fmt::join(values, " ")),
        [&](const std::string& answer) -> std::optional<std::string> {
          if (auto preferred = analysis::preferred_frequencies(answer)) {
            values = std::move(*preferred);
            return values.empty() ? std::optional(fmt::format("none lies in '{}'", answer))
                                  : std::nullopt;
          }
          std::vector<std::string> list;
          std::size_t from = 0;
          while ((from = answer.find_first_not_of(" \t", from)) != std::string::npos) {
            const std::size_t to = std::min(answer.find_first_of(" \t", from), answer.size());
            list.push_back(answer.substr(from, to - from));
            if (!analysis::Frequency::parse(list.back())) {
              return fmt::format("'{}' is not a frequency; write for example 10 12.5 16",
                                 list.back());
            }
            from = to;
          }
          values = std::move(list);
          return std::nullopt;
        });
  }

  [[nodiscard]] bool ended() const { return ended_; }

private:
  std::istream& answers_;
  std::ostream& questions_;
  bool ended_ = false;
};

void ask_for_sensor(Interview& interview, BenchDraft& draft) {
  switch (draft.sensor) {
  case SensorKind::smartup:
    interview.address("Address and UDP port that the unit sends to", draft.listen);
    interview.text("Id of the sensor", draft.sensor_id);
    break;
  case SensorKind::file:
    interview.file("File of the sensor's record", draft.sensor_file);
    interview.text("Its column of the sensor", draft.sensor_channel);
    interview.text("Its column of sync", draft.sensor_sync);
    break;
  case SensorKind::can:
    interview.text("CAN interface", draft.interface);
    interview.optional_file("DBC file of the sensor (empty: one to adapt is written)", draft.dbc);
    break;
  case SensorKind::series:
    interview.address("Address of the sensor, HOST:PORT", draft.sensor_address);
    interview.text("Address of the oscilloscope, HOST:PORT or vxi11:HOST", draft.dso_address);
    break;
  case SensorKind::analogue:
    interview.text("Channel of the sensor in the analogue system", draft.sensor_channel);
    break;
  }
}

void ask_for_places(Interview& interview, BenchDraft& draft) {
  draft.sensor_channel = channel_of(draft);
  ask_for_sensor(interview, draft);
  draft.acs == AcsKind::file
      ? interview.file("File of the analogue system's record", draft.acs_file)
      : interview.address("Address of the analogue system, HOST:PORT", draft.acs_address);
  interview.text("Its channel of the reference", draft.reference);
  interview.optional_file("File of the reference's certificate, reference.toml (empty: later)",
                          draft.reference_file);
  if (draft.sensor != SensorKind::analogue && draft.sensor != SensorKind::can) {
    interview.text("Its channel of sync", draft.sync);
  }
  if (draft.generator == GeneratorKind::scpi) {
    interview.address("Address of the generator, HOST:PORT", draft.generator_address);
  }
  if (draft.generator != GeneratorKind::none) {
    interview.positive("Level at the exciter for 1 V of the generator, in m/s^2",
                       draft.level_per_volt);
    interview.positive("Highest voltage of the generator, amplitude in V", draft.maximum_voltage_v);
  }
}

// Three periods of the lowest frequency at the least.
double usual_duration_s(const BenchDraft& draft) {
  double duration_s = draft.duration_s;
  for (const std::string& text : draft.frequencies_hz) {
    if (const auto frequency = analysis::Frequency::parse(text)) {
      duration_s = std::max(duration_s, std::ceil(3.0 / frequency->hz()));
    }
  }
  return duration_s;
}

} // namespace

Expected<BenchDraft> ask_for_draft(BenchDraft draft, const NameProblem& name_problem,
                                   std::istream& answers, std::ostream& questions) {
  Interview interview(answers, questions);
  interview.text("Name of the bench", draft.name, name_problem);
  interview.choice("Sensor", draft.sensor);
  interview.choice("Analogue system with the reference", draft.acs);
  interview.choice("Generator", draft.generator);
  ask_for_places(interview, draft);
  interview.frequencies(draft.frequencies_hz);
  interview.positive("Level in m/s^2, amplitude", draft.level_m_s2);
  draft.duration_s = usual_duration_s(draft);
  interview.positive("Evaluated seconds of every step", draft.duration_s);
  if (interview.ended()) {
    return fail(ErrorCode::interrupted, "the answers ended early; nothing was written");
  }
  return draft;
}

} // namespace dyncal::inline bench::bench_draft
