#include "services/programs/web/request_router.hpp"

#include <strings.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>

#include <fmt/core.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "services/base/json_text.hpp"
#include "services/base/printable_text.hpp"
#include "services/programs/web/addresses.hpp"
#include "services/programs/web/host_rules.hpp"
#include "services/programs/web/page_files.hpp"
#include "services/programs/web/run_files.hpp"
#include "services/programs/web/served_file.hpp"

namespace dyncal::inline programs::web {
namespace {

using Outcome = httplib::Server::HandlerResponse;

constexpr const char* content_policy =
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

// For a log line: what a visitor wrote, without anything that steers a terminal.
std::string harmless(std::string_view text) {
  return one_line(text, 120);
}

// With parameters or without (RFC 9110, 8.3.1).
bool is_json(std::string_view media_type) {
  constexpr std::string_view json = "application/json";
  const std::string_view rest = media_type.substr(std::min(json.size(), media_type.size()));
  const auto next = rest.find_first_not_of(" \t");
  return media_type.size() >= json.size() &&
         strncasecmp(media_type.data(), json.data(), json.size()) == 0 &&
         (next == std::string_view::npos || rest[next] == ';');
}

bool leads_out(const std::string& path) {
  return path.find("..") != std::string::npos || path.find('\0') != std::string::npos ||
         path.find('\\') != std::string::npos;
}

} // namespace

void answer_json(const nlohmann::ordered_json& json, httplib::Response& response) {
  response.set_content(json_text(json), "application/json");
}

void answer_error(int status, const std::string& code, const std::string& message,
                  httplib::Response& response) {
  response.status = status;
  answer_json({{"error", {{"code", code}, {"message", message}}}}, response);
}

RequestRouter::RequestRouter(DoorOptions options, bus::Clock& clock)
    : options_(std::move(options)), clock_(clock),
      server_(
          refusals_,
          [this](const HeadRefusal& refusal, const std::string& visitor) {
            log_refusal(refusal.reason, fmt::format("a request ({})", refusal.message), visitor);
          },
          options_.certificate) {
  set_up();
}

RequestRouter::~RequestRouter() {
  stop();
}

void RequestRouter::set_up() {
  server_.set_default_headers({{"Content-Security-Policy", content_policy},
                               {"X-Content-Type-Options", "nosniff"},
                               {"X-Frame-Options", "DENY"},
                               {"Referrer-Policy", "no-referrer"},
                               {"Cache-Control", "no-cache"}});
  server_.set_pre_routing_handler(
      [this](const httplib::Request& request, httplib::Response& response) {
        if (check(request, response) == Outcome::Handled) {
          return Outcome::Handled;
        }
        if (request.method == "POST") { // with its body
          return Outcome::Unhandled;
        }
        get(request, response);
        return Outcome::Handled;
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

Expected<void> RequestRouter::start() {
  const drivers::Address& at = options_.listen;
  port_ = server_.bind(at.host, at.port);
  if (port_ < 0) {
    const char* reason = errno == 0 ? "no such address" : std::strerror(errno);
    return fail(ErrorCode::network, fmt::format("cannot listen at {} ({}); choose another address "
                                                "or port with --listen",
                                                at.text(), reason));
  }
  server_.begin();
  return {};
}

std::string RequestRouter::address() const {
  const drivers::Address at{options_.listen.host, static_cast<std::uint16_t>(port_)};
  return fmt::format("{}://{}/", options_.certificate ? "https" : "http", at.text());
}

bool RequestRouter::wait_until(std::chrono::steady_clock::time_point time) {
  std::unique_lock lock(end_mutex_);
  return !end_.wait_until(lock, time, [this] { return server_.is_ending(); });
}

void RequestRouter::stop() {
  {
    const std::lock_guard lock(end_mutex_);
    server_.end();
  }
  end_.notify_all();
  server_.join();
}

void RequestRouter::refuse(Refusal refusal, int status, const std::string& message,
                           const httplib::Request& request, httplib::Response& response) {
  refusals_.count(refusal);
  answer_error(status, to_string(refusal), message, response);
  log_refusal(refusal,
              fmt::format("{} {} ({})", harmless(request.method), harmless(request.path), message),
              request.remote_addr);
}

void RequestRouter::log_refusal(Refusal refusal, const std::string& what,
                                const std::string& visitor) {
  const std::lock_guard lock(log_mutex_);
  if (clock_.now() >= next_line_) {
    next_line_ = clock_.now() + std::chrono::seconds(1);
    spdlog::warn("refused {} of {}: {}", what, visitor, to_string(refusal));
  }
}

Outcome RequestRouter::check(const httplib::Request& request, httplib::Response& response) {
  const auto refused = [&](Refusal refusal, int status, const char* message) {
    refuse(refusal, status, message, request, response);
    return Outcome::Handled;
  };
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
  const auto refuses = [&](const Handler& handler) { return handler(request, response); };
  return std::any_of(request_handlers_.begin(), request_handlers_.end(), refuses)
             ? Outcome::Handled
             : check_method(request, response);
}

Outcome RequestRouter::check_method(const httplib::Request& request, httplib::Response& response) {
  const char* methods = methods_of(request.path);
  if (methods == nullptr) {
    refuse(Refusal::not_found, 404, "there is no such address", request, response);
    return Outcome::Handled;
  }
  if (request.method == "OPTIONS") {
    response.set_header("Allow", methods);
    response.status = 200;
    return Outcome::Handled;
  }
  if (!allows(methods, request.method)) {
    response.set_header("Allow", methods);
    refuse(Refusal::malformed, 405, fmt::format("this address answers {}", methods), request,
           response);
    return Outcome::Handled;
  }
  return Outcome::Unhandled;
}

void RequestRouter::get(const httplib::Request& request, httplib::Response& response) {
  if (serve_page(request, response) ||
      serve_folder("/javascript/", options_.javascript_folder, request, response) ||
      serve_folder("/guide/", options_.guide_folder, request, response)) {
    return;
  }
  for (const Handler& handler : get_handlers_) {
    if (handler(request, response)) {
      return;
    }
  }
  refuse(Refusal::not_found, 404, "there is no such address", request, response);
}

// Debian's libraries link to each other, within their folder.
bool RequestRouter::serve_folder(const std::string& prefix, const std::string& folder,
                                 const httplib::Request& request,
                                 httplib::Response& response) const {
  if (!request.path.starts_with(prefix) || folder.empty()) {
    return false;
  }
  std::string name = request.path.substr(prefix.size());
  name += name.empty() || name.ends_with('/') ? "index.html" : "";
  const auto file = open_beneath(folder, name, Links::within);
  if (file) {
    answer_with(*file, media_type(name), request, response);
  }
  return file.has_value();
}

bool RequestRouter::serve_page(const httplib::Request& request, httplib::Response& response) const {
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

void RequestRouter::post(const httplib::Request& request, httplib::Response& response) {
  if (!is_json(request.get_header_value("Content-Type"))) {
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
void RequestRouter::complete_error(const httplib::Request& request, httplib::Response& response) {
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

} // namespace dyncal::inline programs::web
