// The rules of HTTP/1.1 for the head of a request (RFC 9112, sections 2 to 6; RFC 9110), before
// anybody acts on it: where it ends, how long its body is, and what is refused.
//
//   400  no request: line, target or field is malformed, Host is not there once, the length is no
//        number, or there are two of it
//   411  a body of unknown length (chunked)           413  a body above `max_body_bytes`
//   414  the first line is above `max_line_bytes`     415  a body that is compressed
//   417  an expectation but 100-continue              431  too many or too large fields
//   501  a method or coding that is not known         505  a version but HTTP/1
//
// What is passed on is written again so that the library has nothing to decide: the target in
// origin form with the Host it names, a length, no expectation, and Range under another name, as
// the library would cut every answer by it, errors too. Plain functions; any thread.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "services/programs/web/refusals.hpp"

namespace dyncal::inline programs::web {

inline constexpr std::size_t max_body_bytes = std::size_t{64} * 1024;
inline constexpr std::size_t max_line_bytes = std::size_t{8} * 1024; // of which 1 kB is an address
inline constexpr std::size_t max_head_bytes = std::size_t{16} * 1024;
inline constexpr std::size_t max_fields = 100;

// What the visitor wrote as Range.
inline constexpr const char* range_field = "Dyncal-Range";

struct HeadRefusal {
  int status = 400;
  Refusal reason = Refusal::malformed;
  const char* message = "";
};

struct RequestHead {
  std::optional<HeadRefusal> refusal;
  std::size_t bytes = 0; // of the head, with the empty line at its end
  std::size_t body_bytes = 0;
  bool wants_continue = false; // waits for "100 Continue" before it sends the body
  std::string text;            // as it is passed on, with the empty line
};

// Of what has come of a connection, which begins with a request. Nothing: the head is not whole,
// and may still be one.
[[nodiscard]] std::optional<RequestHead> read_head(std::string_view received);

} // namespace dyncal::inline programs::web
