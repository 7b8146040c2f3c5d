// The HTTP server of cpp-httplib for visitors that nobody invited: a connection has a thread only
// while its request is answered.
//
// One thread, the reception, listens and reads; a request that has come as a whole, and keeps the
// rules of request_head.hpp, waits in a queue for one of `max_threads` that answer; a connection
// that stays goes back to the reception. So one who sends slowly costs a descriptor and at most
// 80 kB, and one who takes slowly loses his thread as soon as others wait (limited_stream.hpp).
//
//   a whole request has `request_limit` to come, else 408; an idle connection `idle_limit`, and as
//   long what still comes of a request that was refused; a connection has `max_requests`
//   beyond `max_connections` the one that is nearest to its limit without a request is closed; if
//   all have requests that are being answered, newcomers wait in the kernel's queue
//
// Over TLS, hands are shaken within `request_limit`, too. What is refused here is counted and told
// to `on_refused`. The library's own kernel queue holds five: anyone who came sixth in the same
// instant waited for seconds until his computer asked again. It also shares its port with any other
// server that wants it; this one does not. Threads: as httplib::Server.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <httplib.h>

#include "drivers/link/file_descriptor.hpp"
#include "services/programs/web/refusals.hpp"
#include "services/programs/web/request_head.hpp"
#include "services/programs/web/visitor_socket.hpp"

namespace dyncal::inline programs::web {

class LimitedServer final : public httplib::Server {
public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds request_limit{5};
  static constexpr std::chrono::seconds idle_limit{1};
  static constexpr int max_requests = 100;
  static constexpr std::size_t max_threads = 64;
  static constexpr std::size_t max_connections = 512; // of 1024 descriptors that a process has
  static constexpr int max_waiting = 256;             // connections in the kernel's queue
  using OnRefused = std::function<void(const HeadRefusal&, const std::string& visitor)>;

  // `certificate`: nothing for plain text.
  LimitedServer(Refusals& refusals, OnRefused on_refused,
                std::optional<TlsCertificate> certificate = {});
  ~LimitedServer() override;
  LimitedServer(const LimitedServer&) = delete;
  LimitedServer& operator=(const LimitedServer&) = delete;

  // Binds to this port, 0: to any free one, and returns it; negative: it cannot be had (errno).
  [[nodiscard]] int bind(const std::string& host, int port);
  // After bind(): answers, in threads of its own, until end(), which ends every connection.
  void begin();
  void end();
  void join(); // after end(): waits for them
  [[nodiscard]] bool is_ending() const { return ending_; }
  [[nodiscard]] std::uint64_t requests() const { return requests_; }

private:
  struct Connection {
    VisitorSocket socket;
    std::string bytes; // that have come, and are not answered yet
    Clock::time_point limit{};
    int requests = 0;
    bool is_continued = false; // "100 Continue" was sent
    bool is_refused = false;   // what comes is read and dropped
    std::string request;       // as it is passed on, once it is whole
  };
  using Connections = std::list<Connection>;
  enum class Step { wait, answer, close };

  // The reception.
  void receive();
  void accept_all(Connections& waiting);
  void wait_for_bytes(Connections& waiting);
  void read_all(Connections& waiting, const std::vector<short>& events);
  [[nodiscard]] Step read(Connection& connection);
  [[nodiscard]] Step judge(Connection& connection);
  [[nodiscard]] Step refuse(Connection& connection, const HeadRefusal& refusal);
  [[nodiscard]] bool make_room(Connections& waiting);
  void place(Connections& waiting, Connections::iterator one, Step step);
  void end_late(Connections& waiting);
  void take_returned(Connections& waiting);
  // Those that answer.
  void answer_all();
  [[nodiscard]] bool answer(Connection& connection);
  void wake() const;
  void count_crowd() { crowd_ = ready_.size() - std::min(ready_.size(), idle_); } // under mutex_

  Refusals& refusals_;
  OnRefused on_refused_;
  std::optional<TlsCertificate> certificate_;
  drivers::FileDescriptor listening_;
  drivers::FileDescriptor wake_;
  std::atomic<bool> ending_ = false;
  std::atomic<std::uint64_t> requests_ = 0;
  std::atomic<std::size_t> connections_ = 0;
  std::atomic<std::size_t> crowd_ = 0; // requests that wait, as no thread is free
  std::mutex mutex_;
  std::condition_variable is_ready_;
  Connections ready_;    // wait for a thread
  std::size_t idle_ = 0; // threads
  Connections returned_; // to the reception
  std::vector<std::thread> threads_;
};

} // namespace dyncal::inline programs::web
