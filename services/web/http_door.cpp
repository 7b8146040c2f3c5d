#include "services/web/http_door.hpp"

#include <cerrno>
#include <cstring>
#include <exception>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "services/json_text.hpp"
#include "services/printable_text.hpp"
#include "services/web/host_rules.hpp"
#include "services/web/page_files.hpp"
#include "services/web/run_files.hpp"

namespace dyncal::services::web {
namespace {

using Outcome = httplib::Server::HandlerResponse;

constexpr const char* content_policy =
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

// For a log line: what a visitor wrote, without anything that steers a terminal.
std::string harmless(std::string_view text) {
  return printable(text.substr(0, 120));
}

bool leads_out(const std::string& path) {
  return path.find("..") != std::string::npos || path.find('\0') != std::string::npos ||
         path.find('\\') != std::string::npos;
}

} // namespace

void answer_error(int status, const std::string& code, const std::string& message,
                  httplib::Response& response) {
  const nlohmann::ordered_json json{{"error", {{"code", code}, {"message", message}}}};
  response.status = status;
  response.set_content(json_text(json), "application/json");
}

HttpDoor::HttpDoor(DoorOptions options, bus::Clock& clock)
    : options_(std::move(options)), clock_(clock) {
  set_up();
}

HttpDoor::~HttpDoor() {
  stop();
}

void HttpDoor::set_up() {
  server_.set_default_headers({{"Content-Security-Policy", content_policy},
                               {"X-Content-Type-Options", "nosniff"},
                               {"X-Frame-Options", "DENY"},
                               {"Referrer-Policy", "no-referrer"},
                               {"Cache-Control", "no-cache"}});
  server_.set_mount_point("/javascript", options_.javascript_folder);
  if (!options_.guide_folder.empty()) {
    server_.set_mount_point("/guide", options_.guide_folder);
  }
  server_.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        const Outcome outcome = check(request, response);
        return outcome == Outcome::Handled || request.method == "POST" ? outcome
                                                                       : get(request, response);
      });
  server_.Post(".*", [this](const httplib::Request& request, httplib::Response& response) {
    post(request, response);
  });
  server_.set_error_handler(httplib::Server::Handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        complete_error(request, response);
      }));
  server_.set_exception_handler([](const httplib::Request& request, httplib::Response& response,
                                   const std::exception_ptr& thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
      spdlog::error("{}: {}", harmless(request.path), error.what());
    }
    answer_error(500, "failed", "the request could not be answered; the log has the reason",
                 response);
  });
}

Expected<void> HttpDoor::start() {
  const drivers::Address& at = options_.listen;
  port_ = server_.bind(at.host, at.port);
  if (port_ < 0) {
    const char* reason = errno == 0 ? "no such address" : std::strerror(errno);
    return fail(ErrorCode::network, fmt::format("cannot listen at {} ({}); choose another address "
                                                "or port with --listen",
                                                at.text(), reason));
  }
  thread_ = std::thread([this] { server_.listen_after_bind(); });
  return {};
}

bool HttpDoor::wait_until(std::chrono::steady_clock::time_point time) {
  std::unique_lock lock(end_mutex_);
  return !end_.wait_until(lock, time, [this] { return server_.is_ending(); });
}

void HttpDoor::stop() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock(end_mutex_);
      server_.end();
    }
    end_.notify_all();
    thread_.join();
  }
}

void HttpDoor::refuse(Refusal refusal, int status, const std::string& message,
                      const httplib::Request& request, httplib::Response& response) {
  refusals_.count(refusal);
  answer_error(status, to_string(refusal), message, response);
  const std::lock_guard lock(log_mutex_);
  if (clock_.now() >= next_line_) {
    next_line_ = clock_.now() + std::chrono::seconds(1);
    spdlog::warn("refused {} {} of {}: {} ({})", harmless(request.method), harmless(request.path),
                 request.remote_addr, message, to_string(refusal));
  }
}

Outcome HttpDoor::check(const httplib::Request& request, httplib::Response& response) {
  const auto refused = [&](Refusal refusal, int status, const char* message) {
    refuse(refusal, status, message, request, response);
    return Outcome::Handled;
  };
  if (request.method != "GET" && request.method != "HEAD" && request.method != "POST") {
    return refused(Refusal::malformed, 405, "only GET, HEAD and POST are answered");
  }
  const std::string host = request.get_header_value("Host");
  if (!is_own_host(host, options_.own_names)) {
    return refused(Refusal::foreign_host, 421,
                   "Host is not a name of this computer; --own-name adds one");
  }
  if (!is_own_origin(request.get_header_value("Origin"), host)) {
    return refused(Refusal::foreign_origin, 403, "a page of another server asks for this");
  }
  if (request.target.size() > max_address_bytes) {
    return refused(Refusal::too_large, 414, "the address is too long");
  }
  if (leads_out(request.path)) {
    return refused(Refusal::not_found, 404, "there is no such address");
  }
  return Outcome::Unhandled;
}

Outcome HttpDoor::get(const httplib::Request& request, httplib::Response& response) {
  const bool is_file =
      request.path.starts_with("/javascript/") || request.path.starts_with("/guide/");
  if (is_file) {
    return Outcome::Unhandled;
  }
  if (serve_page(request, response)) {
    return Outcome::Handled;
  }
  for (const Handler& handler : get_handlers_) {
    if (handler(request, response)) {
      return Outcome::Handled;
    }
  }
  refuse(Refusal::not_found, 404, "there is no such address", request, response);
  return Outcome::Handled;
}

bool HttpDoor::serve_page(const httplib::Request& request, httplib::Response& response) const {
  static const std::vector<PageFile> files = page_files();
  constexpr std::string_view folder = "/page/";
  const bool is_page = request.path == "/";
  if (!is_page && !request.path.starts_with(folder)) {
    return false;
  }
  const std::string name = is_page ? "index.html" : request.path.substr(folder.size());
  for (const PageFile& file : files) {
    if (file.name == name) {
      response.set_content(file.bytes, file.count, media_type(name));
      return true;
    }
  }
  return false;
}

void HttpDoor::post(const httplib::Request& request, httplib::Response& response) {
  if (!request.get_header_value("Content-Type").starts_with("application/json")) {
    refuse(Refusal::malformed, 415, "Content-Type must be application/json", request, response);
    return;
  }
  for (const Handler& handler : post_handlers_) {
    if (handler(request, response)) {
      return;
    }
  }
  refuse(Refusal::not_found, 404, "there is no such address", request, response);
}

// What the library has refused by itself.
void HttpDoor::complete_error(const httplib::Request& request, httplib::Response& response) {
  if (!response.body.empty()) {
    return;
  }
  const bool is_large = response.status == 413 || response.status == 414;
  const bool is_missing = response.status == 404;
  refuse(is_large     ? Refusal::too_large
         : is_missing ? Refusal::not_found
                      : Refusal::malformed,
         response.status,
         is_large     ? "the request is too large"
         : is_missing ? "there is no such address"
                      : "this is not a request that can be answered",
         request, response);
}

} // namespace dyncal::services::web
