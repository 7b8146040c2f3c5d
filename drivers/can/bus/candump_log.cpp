#include "drivers/can/bus/candump_log.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>
#include <vector>

namespace dyncal::drivers::can {

namespace {

template <class T>
bool read_number(std::string_view text, T& value, int base) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  return error == std::errc() && end == text.data() + text.size();
}

std::optional<std::int64_t> read_stamp(std::string_view text) {
  if (text.size() < 3 || text.front() != '(' || text.back() != ')') {
    return std::nullopt;
  }
  text = text.substr(1, text.size() - 2);
  const std::size_t point = text.find('.');
  if (point == std::string_view::npos || text.size() - point - 1 == 0 ||
      text.size() - point - 1 > 9) {
    return std::nullopt;
  }
  std::int64_t seconds = 0;
  std::string fraction(text.substr(point + 1));
  fraction.resize(9, '0');
  std::int64_t nanoseconds = 0;
  constexpr std::int64_t max_s = 9'000'000'000;
  if (!read_number(text.substr(0, point), seconds, 10) || seconds < 0 || seconds > max_s ||
      !read_number(fraction, nanoseconds, 10)) {
    return std::nullopt;
  }
  return seconds * 1'000'000'000 + nanoseconds;
}

constexpr std::uint32_t error_mark = 0x20000000; // as linux/can.h has it
constexpr std::size_t max_late_lines = 64;
constexpr std::size_t lines_of_one_odd = 100;

bool read_id(std::string_view text, CanFrame& frame) {
  frame.extended = text.size() > 3;
  return read_number(text, frame.id, 16) &&
         (frame.id <= (frame.extended ? 0x1FFFFFFFU : 0x7FFU) || (frame.id & error_mark) != 0);
}

bool read_bytes(std::string_view digits, CanFrame& frame) {
  if (digits.size() % 2 != 0 || digits.size() / 2 > (frame.fd ? 64U : 8U)) {
    return false;
  }
  frame.length = static_cast<std::uint8_t>(digits.size() / 2);
  for (std::size_t i = 0; i < frame.length; ++i) {
    if (!read_number(digits.substr(2 * i, 2), frame.data[i], 16)) {
      return false;
    }
  }
  return true;
}

// id#data
std::optional<CanFrame> read_frame(std::string_view text, std::size_t mark) {
  CanFrame frame;
  if (!read_id(text.substr(0, mark), frame)) {
    return std::nullopt;
  }
  std::string_view data = text.substr(mark + 1);
  if (data.starts_with('#')) {
    unsigned flags = 0;
    if (data.size() < 2 || !read_number(data.substr(1, 1), flags, 16)) {
      return std::nullopt;
    }
    frame.fd = true;
    frame.bit_rate_switch = (flags & 1U) != 0;
    frame.error_state_indicator = (flags & 2U) != 0;
    data.remove_prefix(2);
  } else if (data.starts_with('R')) {
    frame.remote = true;
    data = {};
  }
  return read_bytes(data, frame) ? std::optional(frame) : std::nullopt;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(" \t\r", at)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

// id [length] da ta ...; FD frames give the length in two digits.
std::optional<CanFrame> read_shown_frame(const std::vector<std::string_view>& words) {
  const auto length = std::find_if(words.begin() + 3, words.end(),
                                   [](std::string_view word) { return word.starts_with('['); });
  std::size_t count = 0;
  CanFrame frame;
  if (length == words.end() || length->size() < 3 || length->back() != ']' ||
      !read_number(length->substr(1, length->size() - 2), count, 10) ||
      !read_id(*std::prev(length), frame)) {
    return std::nullopt;
  }
  frame.fd = length->size() > 3;
  std::string digits;
  for (auto word = std::next(length); word != words.end() && digits.size() < 2 * count; ++word) {
    frame.remote = frame.remote || *word == "remote";
    digits += frame.remote ? "" : *word;
  }
  return (frame.remote || digits.size() == 2 * count) && read_bytes(digits, frame)
             ? std::optional(frame)
             : std::nullopt;
}

struct LogLine {
  std::string_view interface_name;
  CanFrame frame;
};

std::optional<LogLine> read_line(std::string_view line) {
  const std::vector<std::string_view> words = words_of(line);
  const auto stamp = words.size() < 3 ? std::nullopt : read_stamp(words[0]);
  if (!stamp) {
    return std::nullopt;
  }
  const std::size_t mark = words[2].find('#');
  auto frame = mark == std::string_view::npos
                   ? (words.size() > 3 ? read_shown_frame(words) : std::nullopt)
                   : read_frame(words[2], mark);
  if (!frame) {
    return std::nullopt;
  }
  frame->kernel_ns = *stamp;
  return LogLine{words[1], *frame};
}

// A clock that was set back stays back; a frame that was written late does not.
void put_late_ones_in_place(std::vector<CanFrame>& frames) {
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const std::int64_t stamp_ns = frames[i].kernel_ns;
    const bool is_late =
        stamp_ns < frames[i - 1].kernel_ns &&
        (i + 1 == frames.size() || frames[i + 1].kernel_ns >= frames[i - 1].kernel_ns);
    if (!is_late) {
      continue;
    }
    const auto here = frames.begin() + static_cast<std::ptrdiff_t>(i);
    const auto first = here - static_cast<std::ptrdiff_t>(std::min(i, max_late_lines));
    const auto place = std::find_if(
        first, here, [stamp_ns](const CanFrame& frame) { return frame.kernel_ns > stamp_ns; });
    if (place != first || first == frames.begin()) {
      std::rotate(place, here, here + 1);
    }
  }
}

} // namespace

Expected<CandumpLog> read_candump_log(const std::filesystem::path& path,
                                      const std::string& interface_name) {
  std::ifstream file(path);
  if (!file) {
    return fail(ErrorCode::not_found, path.string() + ": the log cannot be read");
  }
  CandumpLog log;
  std::string line;
  std::size_t good = 0;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    const bool is_cut_off = file.eof();
    if (words_of(line).empty()) {
      continue;
    }
    const auto read = read_line(line);
    if (!read && !is_cut_off) {
      log.first_passed_over = log.passed_over++ == 0 ? number : log.first_passed_over;
    }
    if (!read) {
      continue;
    }
    ++good;
    const bool is_error = (read->frame.id & error_mark) != 0;
    if (!is_error && (interface_name.empty() || read->interface_name == interface_name)) {
      log.frames.push_back(read->frame);
    }
  }
  if (log.passed_over * lines_of_one_odd > good) {
    return fail(ErrorCode::malformed,
                path.string() + ":" + std::to_string(log.first_passed_over) +
                    ": not a line of candump -l ('(seconds) interface id#data') or candump -ta; "
                    "of all lines " +
                    std::to_string(log.passed_over) + " are none");
  }
  put_late_ones_in_place(log.frames);
  return log;
}

} // namespace dyncal::drivers::can
