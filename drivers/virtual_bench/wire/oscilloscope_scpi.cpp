#include "drivers/virtual_bench/wire/oscilloscope_scpi.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "drivers/virtual_bench/wire/scpi_text.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr std::size_t max_errors = 20;
constexpr std::size_t max_block = 250'000;

// SCPI's rule: four letters, three when the fourth is a vowel; a number at the end stays.
std::string short_form(const std::string& mnemonic) {
  const std::size_t letters = std::min(mnemonic.find_first_of("0123456789"), mnemonic.size());
  if (letters <= 4) {
    return mnemonic;
  }
  const bool vowel = std::string_view("AEIOU").find(mnemonic[3]) != std::string_view::npos;
  return mnemonic.substr(0, vowel ? 3 : 4) + mnemonic.substr(letters);
}

std::string canonical(std::string_view header) {
  std::string text = upper(header);
  if (text.starts_with(':')) {
    text.erase(0, 1);
  }
  if (text.starts_with('*')) {
    return text;
  }
  std::string out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    out += (out.empty() ? "" : ":") + short_form(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

std::optional<std::size_t> parse_input(std::string_view text) {
  const std::string name = canonical(text);
  if (name == "CHAN1") {
    return 0;
  }
  return name == "CHAN2" ? std::optional<std::size_t>(1) : std::nullopt;
}

std::string with_digits(std::size_t value, int digits) {
  char text[32];
  std::snprintf(text, sizeof(text), "%0*zu", digits, value);
  return text;
}

} // namespace

const std::vector<std::string>& scope_fault_names() {
  static const std::vector<std::string> names = {"half-answer",  "garbage",    "wrong-length",
                                                 "other-answer", "disconnect", "slow"};
  return names;
}

void OscilloscopeScpi::complain(const char* error) {
  if (errors_.size() < max_errors) {
    errors_.emplace_back(error);
  }
}

OscilloscopeScpi::Reply OscilloscopeScpi::execute(std::string_view line) {
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) {
    line.remove_suffix(1);
  }
  if (line.empty()) {
    return {};
  }
  const std::size_t space = std::min(line.find(' '), line.size());
  const std::string_view header = line.substr(0, space);
  if (header.ends_with('?')) {
    auto answer = query(canonical(header.substr(0, header.size() - 1)));
    if (!answer) {
      complain("-113,\"Undefined header\"");
      return {};
    }
    return spoiled(std::move(*answer));
  }
  const std::string_view rest = line.substr(space);
  set(canonical(header), rest.substr(std::min(rest.find_first_not_of(' '), rest.size())));
  return {};
}

std::optional<std::string> OscilloscopeScpi::query(const std::string& header) {
  if (header == "*IDN") {
    return "RIGOL TECHNOLOGIES,MSO5072,virtual" + std::to_string(serial_) + ",00.01.03.00.03\n";
  }
  if (header == "*OPC") {
    return "1\n";
  }
  if (header == "SYST:ERR") {
    std::string oldest = errors_.empty() ? "0,\"No error\"" : errors_.front();
    if (!errors_.empty()) {
      errors_.pop_front();
    }
    return oldest + "\n";
  }
  if (header == "TRIG:STAT") {
    const auto state = model_.state();
    return state == OscilloscopeModel::State::stopped   ? "STOP\n"
           : state == OscilloscopeModel::State::waiting ? "WAIT\n"
                                                        : "TD\n";
  }
  if (header == "WAV:SOUR") {
    return source_ == 0 ? "CHAN1\n" : "CHAN2\n";
  }
  if (header == "WAV:PRE") {
    return preamble();
  }
  if (header == "WAV:DATA") {
    return data();
  }
  return std::nullopt;
}

std::string OscilloscopeScpi::preamble() const {
  const ScopeSetting& set = model_.record() ? model_.record()->setting : model_.setting;
  const ScopeInput& input = set.inputs[source_];
  const double y_increment_v = input.volts_per_division / OscilloscopeModel::codes_per_division;
  char text[200];
  std::snprintf(text, sizeof(text), "0,2,%zu,1,%.9E,%.9E,0,%.6E,%.0f,128\n", set.points,
                set.interval_s(), set.origin_s(), y_increment_v, input.offset_v / y_increment_v);
  return text;
}

std::string OscilloscopeScpi::data() {
  if (!model_.record()) {
    return "#9000000000\n";
  }
  const std::string& codes = model_.record()->codes[source_];
  const std::size_t first = std::min(std::max<std::size_t>(first_point_, 1), codes.size() + 1) - 1;
  const std::size_t last = std::min({last_point_, codes.size(), first + max_block});
  const std::string part = codes.substr(first, last > first ? last - first : 0);
  return "#9" + with_digits(part.size(), 9) + part + "\n";
}

void OscilloscopeScpi::set(const std::string& header, std::string_view argument) {
  if (header == "*CLS") {
    errors_.clear();
  } else if (header == "SING") {
    model_.single();
  } else if (header == "STOP") {
    model_.stop();
  } else if (header == "WAV:SOUR" || header == "TRIG:EDGE:SOUR") {
    const auto input = parse_input(argument);
    if (!input || (header == "TRIG:EDGE:SOUR" && *input != 0)) {
      complain("-224,\"Illegal parameter value\"");
    } else if (header == "WAV:SOUR") {
      source_ = *input;
    }
  } else if (header == "SYST:AOUT" || header == "ACQ:TYPE" || header == "TRIG:MODE" ||
             header == "TRIG:COUP" || header == "TRIG:EDGE:SLOP" || header == "WAV:MODE" ||
             header == "WAV:FORM") {
    if (argument.empty()) {
      complain("-109,\"Missing parameter\"");
    }
  } else if (!set_input(header, argument)) {
    set_number(header, argument);
  }
}

bool OscilloscopeScpi::set_input(const std::string& header, std::string_view argument) {
  const std::size_t colon = header.find(':');
  const auto place = colon == std::string::npos
                         ? std::nullopt
                         : parse_input(std::string_view(header).substr(0, colon));
  if (!place) {
    return false;
  }
  ScopeInput& input = model_.setting.inputs[*place];
  const std::string what = header.substr(colon + 1);
  const auto value = parse_parameter(argument);
  if (what == "DISP") {
    input.shown = upper(argument) == "ON" || argument == "1";
  } else if (what == "SCAL" && value && *value >= 1e-3 && *value <= 10.0) {
    input.volts_per_division = *value;
  } else if (what == "OFFS" && value) {
    input.offset_v = *value;
  } else {
    complain("-222,\"Data out of range\"");
  }
  return true;
}

void OscilloscopeScpi::set_number(const std::string& header, std::string_view argument) {
  ScopeSetting& set = model_.setting;
  const auto parsed = parse_parameter(argument);
  const double value = parsed.value_or(0.0);
  const auto take = [&](double lowest, double highest, auto& target) {
    if (!parsed) {
      complain("-104,\"Data type error\"");
    } else if (!(value >= lowest && value <= highest)) {
      complain("-222,\"Data out of range\"");
    } else {
      target = static_cast<std::remove_reference_t<decltype(target)>>(value);
    }
  };
  if (header == "TIM:MAIN:SCAL") {
    take(1e-9, 1000.0, set.seconds_per_division);
  } else if (header == "TIM:MAIN:OFFS") {
    take(-1000.0, 1000.0, set.centre_s);
  } else if (header == "TRIG:EDGE:LEV") {
    take(-100.0, 100.0, set.level_v);
  } else if (header == "ACQ:MDEP") {
    take(1e3, 1e7, set.points);
  } else if (header == "WAV:POIN") {
    std::size_t ignored = 0; // RAW mode delivers what the memory holds
    take(1.0, 1e8, ignored);
  } else if (header == "WAV:STAR") {
    take(1.0, 1e8, first_point_);
  } else if (header == "WAV:STOP") {
    take(1.0, 1e8, last_point_);
  } else {
    complain("-113,\"Undefined header\"");
  }
}

OscilloscopeScpi::Reply OscilloscopeScpi::spoiled(std::string answer) {
  const auto happens = [this](const char* name) {
    const auto found = faults_.find(name);
    return found != faults_.end() && random_.happens(found->second);
  };
  if (happens("half-answer")) {
    return {answer.substr(0, answer.size() / 2), false, false};
  }
  if (happens("disconnect")) {
    return {answer.substr(0, answer.size() / 2), true, false};
  }
  if (happens("garbage")) {
    return {"\x15\x7f#\x02?!\n", false, false};
  }
  if (happens("other-answer")) {
    return {"1.000000E-03\n", false, false};
  }
  if (answer.starts_with("#9") && happens("wrong-length")) {
    answer.replace(2, 9, with_digits(answer.size() - 12 + 7, 9));
  }
  return {std::move(answer), false, happens("slow")};
}

} // namespace dyncal::drivers::virtual_bench
