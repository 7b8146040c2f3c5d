#include "services/programs/web/limited_server.hpp"

#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include <fmt/core.h>

#include "services/programs/web/limited_stream.hpp"
#include "services/programs/web/request_router.hpp"

namespace dyncal::inline programs::web {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t read_bytes = 4096;
// Of a request and what a visitor sent after it without waiting.
constexpr std::size_t max_received_bytes = max_head_bytes + max_body_bytes;
constexpr std::chrono::milliseconds longest_wait = 200ms;
constexpr std::string_view continue_text = "HTTP/1.1 100 Continue\r\n\r\n";
constexpr HeadRefusal too_slow{408, Refusal::slow, "the request did not come in time"};

// Without a reason phrase, which nobody has to read (RFC 9112, 4); the body has a sentence.
std::string text_of(const HeadRefusal& refusal) {
  httplib::Response response;
  answer_error(refusal.status, to_string(refusal.reason), refusal.message, response);
  return fmt::format("HTTP/1.1 {} \r\nContent-Type: application/json\r\n"
                     "X-Content-Type-Options: nosniff\r\nCache-Control: no-cache\r\n"
                     "Connection: close\r\nContent-Length: {}\r\n\r\n{}",
                     refusal.status, response.body.size(), response.body);
}

} // namespace

LimitedServer::LimitedServer(Refusals& refusals, OnRefused on_refused,
                             std::optional<TlsCertificate> certificate)
    : refusals_(refusals), on_refused_(std::move(on_refused)), certificate_(std::move(certificate)),
      wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  set_payload_max_length(max_body_bytes);
  set_socket_options([](socket_t socket) {
    // So that a daemon that starts again need not wait for connections of the one before.
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  set_keep_alive_max_count(max_requests); // for what it tells the visitor
  set_keep_alive_timeout(idle_limit.count());
}

int LimitedServer::bind(const std::string& host, int port) {
  errno = 0;
  if (port == 0) {
    port = bind_to_any_port(host);
  } else if (!bind_to_port(host, port)) {
    return -1;
  }
  // The library has called it with a queue of five.
  if (port <= 0 || ::listen(svr_sock_, max_waiting) != 0) {
    return -1;
  }
  listening_ = drivers::FileDescriptor(svr_sock_);
  // A visitor who has gone again before he is taken holds nobody up.
  fcntl(svr_sock_, F_SETFL, fcntl(svr_sock_, F_GETFL) | O_NONBLOCK);
  return port;
}

void LimitedServer::begin() {
  threads_.emplace_back([this] { receive(); });
  for (std::size_t i = 0; i < max_threads; ++i) {
    threads_.emplace_back([this] { answer_all(); });
  }
}

void LimitedServer::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  is_ready_.notify_all();
  wake();
}

void LimitedServer::join() {
  for (std::thread& thread : threads_) {
    thread.join();
  }
  threads_.clear();
}

LimitedServer::~LimitedServer() {
  end();
  join();
}

void LimitedServer::wake() const {
  const std::uint64_t one = 1;
  (void)!::write(wake_.number(), &one, sizeof(one));
}

void LimitedServer::receive() {
  Connections waiting;
  while (!ending_) {
    take_returned(waiting);
    wait_for_bytes(waiting);
    end_late(waiting);
  }
}

void LimitedServer::end_late(Connections& waiting) {
  const auto now = Clock::now();
  for (auto one = waiting.begin(); one != waiting.end();) {
    const auto next = std::next(one);
    if (now >= one->limit) {
      const bool has_begun = !one->bytes.empty() && !one->is_refused;
      place(waiting, one, has_begun ? refuse(*one, too_slow) : Step::close);
    }
    one = next;
  }
}

void LimitedServer::place(Connections& waiting, Connections::iterator one, Step step) {
  if (step == Step::close) {
    waiting.erase(one);
    --connections_;
  } else if (step == Step::answer) {
    const std::lock_guard lock(mutex_);
    ready_.splice(ready_.end(), waiting, one);
    count_crowd();
    is_ready_.notify_one();
  }
}

// And for newcomers, answered ones, and the next limit.
void LimitedServer::wait_for_bytes(Connections& waiting) {
  std::vector<pollfd> polled{{.fd = wake_.number(), .events = POLLIN, .revents = 0},
                             {.fd = listening_.number(), .events = POLLIN, .revents = 0}};
  const bool has_room = connections_ < max_connections || !waiting.empty();
  polled[1].events = has_room ? POLLIN : 0;
  auto next = Clock::now() + longest_wait;
  for (const Connection& one : waiting) {
    polled.push_back({.fd = one.socket.number(), .events = POLLIN, .revents = 0});
    next = std::min(next, one.limit);
  }
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(next - Clock::now());
  if (poll(polled.data(), polled.size(), static_cast<int>(std::max(left, 0ms).count())) <= 0) {
    return;
  }
  std::uint64_t count = 0;
  (void)!::read(wake_.number(), &count, sizeof(count));
  std::vector<short> events;
  for (std::size_t i = 2; i < polled.size(); ++i) {
    events.push_back(polled[i].revents);
  }
  read_all(waiting, events);
  if (polled[1].revents != 0) {
    accept_all(waiting);
  }
}

// As many as can wait in the kernel's queue, then the others' turn.
void LimitedServer::accept_all(Connections& waiting) {
  for (int i = 0; i < max_waiting; ++i) {
    pollfd one{.fd = listening_.number(), .events = POLLIN, .revents = 0};
    if (poll(&one, 1, 0) <= 0 || !make_room(waiting)) {
      return;
    }
    drivers::FileDescriptor socket(
        ::accept4(listening_.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.is_open()) {
      return;
    }
    const int yes = 1;
    setsockopt(socket.number(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    VisitorSocket visitor(std::move(socket), certificate_ ? &*certificate_ : nullptr);
    if (!visitor.is_open()) {
      continue;
    }
    ++connections_;
    const Clock::duration limit = certificate_ ? request_limit : idle_limit;
    waiting.push_back(
        {.socket = std::move(visitor), .bytes = {}, .limit = Clock::now() + limit, .request = {}});
  }
}

bool LimitedServer::make_room(Connections& waiting) {
  if (connections_ < max_connections) {
    return true;
  }
  const auto nearest = std::ranges::min_element(waiting, {}, &Connection::limit);
  if (nearest == waiting.end()) {
    return false;
  }
  refusals_.count(Refusal::slow);
  waiting.erase(nearest);
  --connections_;
  return true;
}

void LimitedServer::take_returned(Connections& waiting) {
  Connections returned;
  {
    const std::lock_guard lock(mutex_);
    returned.swap(returned_);
  }
  for (auto one = returned.begin(); one != returned.end();) {
    const auto next = std::next(one);
    one->limit = Clock::now() + (one->bytes.empty() ? idle_limit : request_limit);
    waiting.splice(waiting.end(), returned, one);
    place(waiting, one, judge(*one)); // the next request may have come with the last one
    one = next;
  }
}

void LimitedServer::read_all(Connections& waiting, const std::vector<short>& events) {
  auto one = waiting.begin();
  for (const short event : events) {
    const auto next = std::next(one);
    place(waiting, one, event == 0 ? Step::wait : read(*one));
    one = next;
  }
}

LimitedServer::Step LimitedServer::read(Connection& connection) {
  std::array<char, read_bytes> part{};
  bool has_ended = false;
  while (connection.bytes.size() < max_received_bytes) {
    const ssize_t count = connection.socket.receive(part.data(), part.size());
    if (count <= 0) {
      has_ended = count == VisitorSocket::has_ended;
      break;
    }
    if (connection.bytes.empty() && !connection.is_refused) {
      connection.limit = Clock::now() + request_limit;
    }
    connection.bytes.append(part.data(), static_cast<std::size_t>(count));
    if (connection.is_refused) {
      connection.bytes.clear();
    }
  }
  const Step step = connection.is_refused ? Step::wait : judge(connection);
  return has_ended && step == Step::wait ? Step::close : step;
}

LimitedServer::Step LimitedServer::judge(Connection& connection) {
  while (connection.bytes.starts_with("\r\n")) { // RFC 9112, 2.2
    connection.bytes.erase(0, 2);
  }
  const auto head = read_head(connection.bytes);
  if (!head) {
    return Step::wait;
  }
  if (head->refusal) {
    return refuse(connection, *head->refusal);
  }
  const std::size_t whole = head->bytes + head->body_bytes;
  if (connection.bytes.size() < whole) {
    if (head->wants_continue && !connection.is_continued) {
      connection.socket.tell(continue_text);
      connection.is_continued = true;
    }
    return Step::wait;
  }
  connection.request = head->text + connection.bytes.substr(head->bytes, head->body_bytes);
  connection.bytes.erase(0, whole);
  connection.is_continued = false;
  return Step::answer;
}

// Reads on for a while: an answer to somebody who is still sending is lost with the connection.
LimitedServer::Step LimitedServer::refuse(Connection& connection, const HeadRefusal& refusal) {
  refusals_.count(refusal.reason);
  on_refused_(refusal, visitor_of(connection.socket.number()));
  connection.socket.tell(text_of(refusal));
  connection.socket.end_sending();
  connection.is_refused = true;
  connection.bytes.clear();
  connection.limit = Clock::now() + idle_limit;
  return Step::wait;
}

void LimitedServer::answer_all() {
  while (true) {
    Connections mine;
    {
      std::unique_lock lock(mutex_);
      ++idle_;
      is_ready_.wait(lock, [this] { return ending_ || !ready_.empty(); });
      --idle_;
      if (ending_) {
        return;
      }
      mine.splice(mine.begin(), ready_, ready_.begin());
      count_crowd();
    }
    if (!answer(mine.front())) {
      mine.front().socket.end_sending();
      --connections_;
      continue;
    }
    {
      const std::lock_guard lock(mutex_);
      returned_.splice(returned_.end(), mine);
    }
    wake();
  }
}

// False: the connection is closed.
bool LimitedServer::answer(Connection& connection) {
  LimitedStream stream(connection.socket, std::move(connection.request), ending_, crowd_);
  connection.request.clear();
  ++connection.requests;
  bool is_closed = false;
  const bool is_last = connection.requests >= max_requests;
  const auto nothing = [](httplib::Request&) {};
  // Newer versions of the library are told of the visitor, and do not ask the stream.
  std::string visitor;
  int port = 0;
  stream.get_remote_ip_and_port(visitor, port);
  const auto process = [&](auto& server) {
    if constexpr (requires { server.process_request(stream, is_last, is_closed, nothing); }) {
      return server.process_request(stream, is_last, is_closed, nothing);
    } else {
      return server.process_request(stream, visitor, port, "", 0, is_last, is_closed, nothing);
    }
  };
  const bool was_served = process(*this);
  ++requests_;
  if (stream.was_slow()) {
    refusals_.count(Refusal::slow);
    return false;
  }
  return was_served && !is_closed && connection.requests < max_requests;
}

} // namespace dyncal::inline programs::web
