#include "services/programs/web/request_head.hpp"

#include <strings.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

namespace dyncal::inline programs::web {
namespace {

constexpr std::string_view line_end = "\r\n";
constexpr std::array<std::string_view, 8> known_methods{"GET", "HEAD",   "POST",  "OPTIONS",
                                                        "PUT", "DELETE", "PATCH", "TRACE"};

constexpr HeadRefusal no_request{400, Refusal::malformed, "this is not a request of HTTP/1.1"};
constexpr HeadRefusal bad_host{400, Refusal::malformed, "a request names its Host once"};
constexpr HeadRefusal bad_length{400, Refusal::malformed,
                                 "Content-Length must be one number, and the only length"};
constexpr HeadRefusal no_length{411, Refusal::malformed, "state the Content-Length of the body"};
constexpr HeadRefusal large_body{413, Refusal::too_large, "the request is too large"};
constexpr HeadRefusal long_line{414, Refusal::too_large, "the address is too long"};
constexpr HeadRefusal compressed{415, Refusal::malformed, "the body must not be compressed"};
constexpr HeadRefusal expectation{417, Refusal::malformed, "only 100-continue can be expected"};
constexpr HeadRefusal large_head{431, Refusal::too_large,
                                 "the fields of the request are too large"};
constexpr HeadRefusal unknown_method{501, Refusal::malformed, "this method is not known"};
constexpr HeadRefusal unknown_coding{501, Refusal::malformed, "this coding is not known"};
constexpr HeadRefusal other_version{505, Refusal::malformed, "only HTTP/1.1 is spoken"};

struct Field {
  std::string_view name;
  std::string_view value;
};
using Fields = std::vector<Field>;

bool is_same(std::string_view one, std::string_view other) {
  return one.size() == other.size() && strncasecmp(one.data(), other.data(), one.size()) == 0;
}

// RFC 9110, 5.6.2
bool is_token(std::string_view text) {
  constexpr std::string_view marks = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char letter) {
    return (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
           (letter >= 'A' && letter <= 'Z') || marks.find(letter) != std::string_view::npos;
  });
}

bool is_control(char letter) {
  const auto code = static_cast<unsigned char>(letter);
  return (code < 0x20 && letter != '\t') || code == 0x7f;
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), is_control);
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t";
  const auto first = text.find_first_not_of(blanks);
  return first == std::string_view::npos
             ? std::string_view()
             : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

// The first line of `rest`, which it is taken from.
std::string_view take_line(std::string_view& rest) {
  const auto end = rest.find(line_end);
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + line_end.size());
  return line;
}

struct RequestLine {
  std::string_view method;
  std::string_view target;
  std::string_view authority; // of an absolute target
  bool is_1_0 = false;
};

// "http://lab-1:8080/x" is "/x" of "lab-1:8080" (RFC 9112, 3.2.2).
bool take_target(std::string_view target, RequestLine& line) {
  constexpr std::string_view scheme = "http://";
  line.target = target;
  if (target.size() > scheme.size() && is_same(target.substr(0, scheme.size()), scheme)) {
    const auto path = target.find_first_of("/?", scheme.size());
    line.authority = target.substr(scheme.size(), path - scheme.size());
    line.target = path == std::string_view::npos ? "/" : target.substr(path);
  }
  const bool is_all = line.target == "*" && line.method == "OPTIONS";
  const bool is_path = line.target.starts_with('/') || !line.authority.empty();
  return (is_all || is_path) && line.target.find('#') == line.target.npos;
}

std::optional<HeadRefusal> take_request_line(std::string_view text, RequestLine& line) {
  const auto first = text.find(' ');
  const auto last = text.rfind(' ');
  if (first == std::string_view::npos || first == last || has_control(text)) {
    return no_request;
  }
  line.method = text.substr(0, first);
  const std::string_view target = text.substr(first + 1, last - first - 1);
  const std::string_view version = text.substr(last + 1);
  const bool is_version = version.size() == 8 && version.starts_with("HTTP/") &&
                          version[5] >= '0' && version[5] <= '9' && version[6] == '.' &&
                          version[7] >= '0' && version[7] <= '9';
  if (!is_token(line.method) || !is_version || target.empty() ||
      target.find(' ') != std::string_view::npos) {
    return no_request;
  }
  if (version[5] != '1') {
    return other_version;
  }
  line.is_1_0 = version[7] == '0';
  if (std::find(known_methods.begin(), known_methods.end(), line.method) == known_methods.end()) {
    return unknown_method;
  }
  return take_target(target, line) ? std::nullopt : std::optional(no_request);
}

std::optional<HeadRefusal> take_fields(std::string_view rest, Fields& fields) {
  while (!rest.empty()) {
    const std::string_view line = take_line(rest);
    const auto colon = line.find(':');
    if (colon == std::string_view::npos || !is_token(line.substr(0, colon)) || has_control(line)) {
      return no_request; // also a line that continues the one before (obs-fold)
    }
    if (fields.size() >= max_fields) {
      return large_head;
    }
    fields.push_back({line.substr(0, colon), trimmed(line.substr(colon + 1))});
  }
  return std::nullopt;
}

std::vector<std::string_view> values_of(const Fields& fields, std::string_view name) {
  std::vector<std::string_view> values;
  for (const Field& field : fields) {
    if (is_same(field.name, name)) {
      values.push_back(field.value);
    }
  }
  return values;
}

std::optional<HeadRefusal> take_length(const Fields& fields, std::size_t& bytes) {
  const auto lengths = values_of(fields, "Content-Length");
  const auto codings = values_of(fields, "Transfer-Encoding");
  if (lengths.size() > 1 || (!lengths.empty() && !codings.empty())) {
    return bad_length;
  }
  if (!codings.empty()) {
    return codings.size() == 1 && is_same(codings.front(), "chunked") ? no_length : unknown_coding;
  }
  if (lengths.empty()) {
    return std::nullopt;
  }
  const std::string_view text = lengths.front();
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos) {
    return bad_length;
  }
  const auto read = std::from_chars(text.data(), text.data() + text.size(), bytes);
  return read.ec != std::errc() || bytes > max_body_bytes ? std::optional(large_body)
                                                          : std::nullopt;
}

std::optional<HeadRefusal> check_fields(const RequestLine& line, const Fields& fields,
                                        RequestHead& head) {
  const std::size_t hosts = values_of(fields, "Host").size();
  if (hosts > 1 || (hosts == 0 && !line.is_1_0)) {
    return bad_host;
  }
  if (const auto refusal = take_length(fields, head.body_bytes)) {
    return refusal;
  }
  for (const std::string_view coding : values_of(fields, "Content-Encoding")) {
    if (!is_same(coding, "identity")) {
      return compressed;
    }
  }
  for (const std::string_view expected : values_of(fields, "Expect")) {
    if (!is_same(expected, "100-continue")) {
      return expectation;
    }
    head.wants_continue = !line.is_1_0 && head.body_bytes > 0;
  }
  return std::nullopt;
}

bool is_passed_on(const RequestLine& line, const Field& field) {
  return !is_same(field.name, "Expect") && !is_same(field.name, "Content-Length") &&
         !is_same(field.name, range_field) &&
         !(is_same(field.name, "Host") && !line.authority.empty());
}

void write_text(const RequestLine& line, const Fields& fields, RequestHead& head) {
  const auto add = [&](std::initializer_list<std::string_view> parts) {
    for (const std::string_view part : parts) {
      head.text += part;
    }
    head.text += line_end;
  };
  add({line.method, line.target.starts_with('?') ? " /" : " ", line.target,
       line.is_1_0 ? " HTTP/1.0" : " HTTP/1.1"});
  if (!line.authority.empty()) {
    add({"Host: ", line.authority});
  }
  for (const Field& field : fields) {
    if (is_passed_on(line, field)) {
      add({is_same(field.name, "Range") ? range_field : field.name, ": ", field.value});
    }
  }
  add({"Content-Length: ", std::to_string(head.body_bytes)});
  head.text += line_end;
}

// Of a head that is not whole.
std::optional<HeadRefusal> check_part(std::string_view received) {
  if (received.find(line_end) == std::string_view::npos && received.size() > max_line_bytes) {
    return long_line;
  }
  return received.size() > max_head_bytes ? std::optional(large_head) : std::nullopt;
}

} // namespace

std::optional<RequestHead> read_head(std::string_view received) {
  RequestHead head;
  const auto end = received.find("\r\n\r\n");
  if (end == std::string_view::npos || end > max_head_bytes) {
    head.refusal = check_part(received.substr(0, end));
    return head.refusal ? std::optional(head) : std::nullopt;
  }
  head.bytes = end + 2 * line_end.size();
  std::string_view rest = received.substr(0, end);
  const std::string_view first = take_line(rest);
  RequestLine line;
  Fields fields;
  head.refusal =
      first.size() > max_line_bytes ? std::optional(long_line) : take_request_line(first, line);
  if (!head.refusal) {
    head.refusal = take_fields(rest, fields);
  }
  if (!head.refusal) {
    head.refusal = check_fields(line, fields, head);
  }
  if (!head.refusal) {
    write_text(line, fields, head);
  }
  return head;
}

} // namespace dyncal::inline programs::web
