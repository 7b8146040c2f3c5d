#include "services/contract/run_identity.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/core.h>

#include "services/contract/session_number.hpp"
#include "services/contract/time_name.hpp"

namespace dyncal::inline contract {
namespace {

constexpr std::size_t start_size = std::string_view("20261122T101530.125Z").size();
constexpr std::size_t conductor_size = 8;
constexpr std::size_t tail_size = start_size + 1 + conductor_size;
static_assert(max_run_name + 1 + tail_size == 64);

bool is_ascii_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

bool is_conductor(const std::string& text) {
  return text.size() == conductor_size && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

} // namespace

Expected<RunIdentity> RunIdentity::begin(const std::string& name, std::int64_t utc_ns) {
  if (name.size() > max_run_name) {
    return fail(ErrorCode::bad_argument,
                fmt::format("the name of the run has {} characters, and may have {}; give it a "
                            "shorter one",
                            name.size(), max_run_name));
  }
  const std::string start = time_name(utc_ns);
  return RunIdentity{name.empty() ? start : safe_name(name), start,
                     fmt::format("{:08x}", random_session() & 0xffffffffU)};
}

RunIdentity RunIdentity::parse(const std::string& text) {
  if (text.size() >= tail_size && text[text.size() - conductor_size - 1] == '.') {
    const std::string start = text.substr(text.size() - tail_size, start_size);
    const std::string conductor = text.substr(text.size() - conductor_size);
    const std::string before = text.substr(0, text.size() - tail_size);
    if (is_time_name(start) && is_conductor(conductor)) {
      if (before.empty()) {
        return {start, start, conductor};
      }
      if (before.size() > 1 && before.back() == '.') {
        return {before.substr(0, before.size() - 1), start, conductor};
      }
    }
  }
  return {text, is_time_name(text) ? text : "", ""};
}

std::string RunIdentity::text() const {
  if (conductor.empty()) {
    return name;
  }
  const std::string tail = start + "." + conductor;
  return name == start ? tail : name + "." + tail;
}

bool RunIdentity::is_called(const std::string& typed) const {
  return typed == name || typed == text() || (!conductor.empty() && safe_name(typed) == name);
}

std::string RunIdentity::since() const {
  if (start.empty()) {
    return "";
  }
  return fmt::format("{}-{}-{} {}:{}:{} UTC", start.substr(0, 4), start.substr(4, 2),
                     start.substr(6, 2), start.substr(9, 2), start.substr(11, 2),
                     start.substr(13, 2));
}

std::string called_of(const std::string& run, const std::string& conductor) {
  const RunIdentity identity = RunIdentity::parse(run);
  const std::string since = identity.conductor.empty() ? "" : ", since " + identity.since();
  return fmt::format("run '{}'{}{}", identity.name, conductor.empty() ? "" : " of " + conductor,
                     since);
}

std::string safe_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return !is_ascii_alphanumeric(c) && c != '-' && c != '_' && c != '.'; }, '_');
  return name;
}

} // namespace dyncal::inline contract
