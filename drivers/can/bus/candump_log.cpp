#include "drivers/can/bus/candump_log.hpp"

#include <charconv>
#include <fstream>
#include <optional>
#include <string_view>

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

std::optional<CanFrame> read_frame(std::string_view text) {
  const std::size_t mark = text.find('#');
  CanFrame frame;
  if (mark == std::string_view::npos || !read_number(text.substr(0, mark), frame.id, 16)) {
    return std::nullopt;
  }
  frame.extended = mark > 3;
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
  if (data.size() % 2 != 0 || data.size() / 2 > (frame.fd ? 64U : 8U) ||
      frame.id > (frame.extended ? 0x1FFFFFFFU : 0x7FFU)) {
    return std::nullopt;
  }
  frame.length = static_cast<std::uint8_t>(data.size() / 2);
  for (std::size_t i = 0; i < frame.length; ++i) {
    if (!read_number(data.substr(2 * i, 2), frame.data[i], 16)) {
      return std::nullopt;
    }
  }
  return frame;
}

} // namespace

Expected<std::vector<BusEvent>> read_candump_log(const std::filesystem::path& path,
                                                 const std::string& interface_name) {
  std::ifstream file(path);
  if (!file) {
    return fail(ErrorCode::not_found, path.string() + ": the log cannot be read");
  }
  std::vector<BusEvent> events;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    std::string_view rest = line;
    while (!rest.empty() && (rest.back() == '\r' || rest.back() == ' ')) {
      rest.remove_suffix(1);
    }
    if (rest.empty()) {
      continue;
    }
    const std::size_t first = rest.find(' ');
    const std::size_t second = first == std::string_view::npos ? first : rest.find(' ', first + 1);
    const auto stamp =
        second == std::string_view::npos ? std::nullopt : read_stamp(rest.substr(0, first));
    auto frame = stamp
                     ? read_frame(rest.substr(second + 1, rest.find(' ', second + 1) - second - 1))
                     : std::nullopt;
    if (!frame) {
      return fail(ErrorCode::malformed,
                  path.string() + ":" + std::to_string(number) +
                      ": not a line of candump -l ('(seconds) interface id#data')");
    }
    if (!interface_name.empty() && rest.substr(first + 1, second - first - 1) != interface_name) {
      continue;
    }
    frame->kernel_ns = *stamp;
    events.emplace_back(*frame);
  }
  return events;
}

} // namespace dyncal::drivers::can
