// What the daemon answers to a request: the rules that every request has to keep, then the answer
// of anyone who knows (PROTOCOL.md has all addresses).
//
// Handlers are asked in their order; the first that answers has answered. They are called by the
// server's threads, several at a time. An error is JSON with code and message; what is refused is
// counted and logged, at most one line a second.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <httplib.h>
#include <nlohmann/json_fwd.hpp>

#include "drivers/link/address.hpp"
#include "services/base/error.hpp"
#include "services/bus/clock.hpp"
#include "services/programs/web/limited_server.hpp"
#include "services/programs/web/refusals.hpp"
#include "services/programs/web/tls_certificate.hpp"

namespace dyncal::inline programs::web {

// With JSON, and with that of an error.
void answer_json(const nlohmann::ordered_json& json, httplib::Response& response);
void answer_error(int status, const std::string& code, const std::string& message,
                  httplib::Response& response);

struct DoorOptions {
  drivers::Address listen{"127.0.0.1", 8080}; // port 0: any free one
  std::vector<std::string> own_names;         // of this computer, for Host
  std::string javascript_folder = "/usr/share/javascript";
  std::string guide_folder{};                  // empty: no guide
  std::optional<TlsCertificate> certificate{}; // nothing: plain text
};

class RequestRouter {
public:
  static constexpr std::size_t max_address_bytes = 1024;
  // Of a GET: false if the address is another's. Of a POST likewise, with its body.
  using Handler = std::function<bool(const httplib::Request&, httplib::Response&)>;

  // `clock` outlives the object.
  RequestRouter(DoorOptions options, bus::Clock& clock);
  ~RequestRouter();
  RequestRouter(const RequestRouter&) = delete;
  RequestRouter& operator=(const RequestRouter&) = delete;

  // Before start(). Of each request, before all others: true if it is refused, and answered.
  void on_request(Handler handler) { request_handlers_.push_back(std::move(handler)); }
  void on_get(Handler handler) { get_handlers_.push_back(std::move(handler)); }
  void on_post(Handler handler) { post_handlers_.push_back(std::move(handler)); }
  // Listens, in threads of its own. Fails (network) when the address cannot be listened at.
  [[nodiscard]] Expected<void> start();
  void stop();

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string address() const; // "https://192.0.2.7:8443/"
  [[nodiscard]] std::uint64_t requests() const { return server_.requests(); }
  [[nodiscard]] const Refusals& refusals() const { return refusals_; }
  // Returns false at once if the router is being closed.
  [[nodiscard]] bool wait_until(std::chrono::steady_clock::time_point time);
  // Counts, logs (a line a second) and answers.
  void refuse(Refusal refusal, int status, const std::string& message,
              const httplib::Request& request, httplib::Response& response);

private:
  using Outcome = httplib::Server::HandlerResponse;

  void set_up();
  [[nodiscard]] Outcome check(const httplib::Request& request, httplib::Response& response);
  [[nodiscard]] Outcome check_method(const httplib::Request& request, httplib::Response& response);
  void get(const httplib::Request& request, httplib::Response& response);
  [[nodiscard]] bool serve_folder(const std::string& prefix, const std::string& folder,
                                  const httplib::Request& request,
                                  httplib::Response& response) const;
  [[nodiscard]] bool serve_page(const httplib::Request& request, httplib::Response& response) const;
  void log_refusal(Refusal refusal, const std::string& what, const std::string& visitor);
  void post(const httplib::Request& request, httplib::Response& response);
  void complete_error(const httplib::Request& request, httplib::Response& response);

  DoorOptions options_;
  bus::Clock& clock_;
  Refusals refusals_;
  LimitedServer server_;
  std::vector<Handler> request_handlers_;
  std::vector<Handler> get_handlers_;
  std::vector<Handler> post_handlers_;
  std::mutex end_mutex_;
  std::condition_variable end_;
  std::mutex log_mutex_;
  bus::Clock::Instant next_line_{};
  int port_ = 0;
};

} // namespace dyncal::inline programs::web
