// A VXI-11 instrument for tests, as far as messages go: portmapper (port 111) and core channel over
// ONC RPC, on the loopback interface, from a thread of its own. The wire forms are those of the
// VXIbus specification's RPCL; procedures: create_link, device_write, device_read, destroy_link. An
// answer leaves in pieces of `piece_bytes`, the last with the END reason; a read without an answer
// is error 15 (timeout). One at a time in a process: the RPC library's tables are global. open() is
// false when port 111 is not to be had.
#pragma once

#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <cstdarg>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <sys/select.h>
#include <thread>
#include <utility>

#include <rpc/rpc.h>

#include <rpc/pmap_prot.h>
#include <rpc/svc_soc.h>

namespace dyncal::drivers {

class Vxi11Server {
public:
  using Answer = std::function<std::string(const std::string& command)>; // empty: none

  explicit Vxi11Server(Answer answer, std::size_t piece_bytes = 100'000)
      : answer_(std::move(answer)), piece_bytes_(piece_bytes) {}
  ~Vxi11Server() {
    thread_ = {};
    for (SVCXPRT* transport : {core_, mapper_tcp_, mapper_udp_}) {
      if (transport != nullptr) {
        svc_destroy(transport);
      }
    }
    current() = nullptr; // the functions stay registered: the same for every server
  }
  Vxi11Server(const Vxi11Server&) = delete;
  Vxi11Server& operator=(const Vxi11Server&) = delete;

  [[nodiscard]] bool open() {
    current() = this;
    const int udp = listening(SOCK_DGRAM, PMAPPORT);
    const int tcp = listening(SOCK_STREAM, PMAPPORT);
    const int core = listening(SOCK_STREAM, 0);
    if (udp < 0 || tcp < 0 || core < 0) {
      return false;
    }
    sockaddr_in address{};
    socklen_t size = sizeof address;
    void* raw = &address;
    getsockname(core, static_cast<sockaddr*>(raw), &size);
    core_port_ = ntohs(address.sin_port);
    mapper_udp_ = svcudp_create(udp);
    mapper_tcp_ = svctcp_create(tcp, 0, 0);
    core_ = svctcp_create(core, 0, 0);
    if (mapper_udp_ == nullptr || mapper_tcp_ == nullptr || core_ == nullptr ||
        !svc_register(mapper_udp_, PMAPPROG, PMAPVERS, map, 0) ||
        !svc_register(mapper_tcp_, PMAPPROG, PMAPVERS, map, 0) ||
        !svc_register(core_, core_program, 1, serve, 0)) {
      return false;
    }
    thread_ = std::jthread([](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        fd_set ready = svc_fdset;
        timeval limit{.tv_sec = 0, .tv_usec = 20'000};
        if (select(FD_SETSIZE, &ready, nullptr, nullptr, &limit) > 0) {
          svc_getreqset(&ready);
        }
      }
    });
    return true;
  }

  std::atomic<int> reads = 0;
  std::atomic<int> links = 0; // open now

private:
  static constexpr rpcprog_t core_program = 0x0607AF;
  static constexpr int end_of_answer = 4;
  static constexpr int io_timeout = 15;

  struct Parameters {
    std::int32_t numbers[5] = {};
    char* text = nullptr; // of the RPC library
    u_int bytes = 0;
  };

  static Vxi11Server*& current() {
    static Vxi11Server* server = nullptr;
    return server;
  }

  static int listening(int type, int port) {
    const int descriptor = socket(AF_INET, type | SOCK_CLOEXEC, 0);
    const int yes = 1;
    setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    const void* raw = &address;
    const bool open = bind(descriptor, static_cast<const sockaddr*>(raw), sizeof address) == 0;
    return open && (type == SOCK_DGRAM || listen(descriptor, 8) == 0) ? descriptor : -1;
  }

  // Whoever asks for a program is sent to the core channel.
  static void map(svc_req* request, SVCXPRT* transport) {
    if (request->rq_proc == PMAPPROC_GETPORT) {
      u_long port = current()->core_port_;
      answer_with(
          transport,
          [](XDR* xdr, void* value) -> bool_t {
            return xdr_u_long(xdr, static_cast<u_long*>(value));
          },
          &port);
    } else {
      svc_sendreply(transport, no_value, nullptr);
    }
  }

  static bool_t no_value(XDR*, ...) { return 1; }

  using Coder = bool_t (*)(XDR*, void*);
  // The RPC library wants a function of any arguments.
  static bool_t chosen_coder(XDR* xdr, ...) {
    va_list arguments;
    va_start(arguments, xdr);
    void* value = va_arg(arguments, void*);
    va_end(arguments);
    return coder()(xdr, value);
  }
  static Coder& coder() {
    static Coder chosen = nullptr; // of the server's thread
    return chosen;
  }
  static void answer_with(SVCXPRT* transport, Coder code, void* value) {
    coder() = code;
    svc_sendreply(transport, chosen_coder, static_cast<char*>(value));
  }

  template <int count, bool with_text>
  static bool_t read_parameters(XDR* xdr, ...) {
    va_list arguments;
    va_start(arguments, xdr);
    auto* parameters = va_arg(arguments, Parameters*);
    va_end(arguments);
    for (int i = 0; i < count; ++i) {
      if (xdr_int32_t(xdr, &parameters->numbers[i]) == 0) {
        return 0;
      }
    }
    return !with_text || xdr_bytes(xdr, &parameters->text, &parameters->bytes, 1U << 20U) != 0 ? 1
                                                                                               : 0;
  }

  static void serve(svc_req* request, SVCXPRT* transport) {
    current()->execute(request->rq_proc, transport);
  }

  void execute(rpcproc_t procedure, SVCXPRT* transport) {
    Parameters parameters;
    void* raw = &parameters;
    switch (procedure) {
    case 10: { // create_link: client, lock, lock timeout, device
      svc_getargs(transport, (read_parameters<3, true>), static_cast<char*>(raw));
      ++links;
      std::int32_t reply[4] = {0, 1, 0, 1 << 20}; // error, link, abort port, most bytes of a write
      answer_with(transport, numbers<4>, reply);
      break;
    }
    case 11: { // device_write: link, timeouts, flags, data
      svc_getargs(transport, (read_parameters<4, true>), static_cast<char*>(raw));
      std::string command(parameters.text == nullptr ? "" : parameters.text, parameters.bytes);
      while (command.ends_with('\n')) {
        command.pop_back();
      }
      waiting_ += answer_(command);
      std::int32_t reply[2] = {0, static_cast<std::int32_t>(parameters.bytes)};
      answer_with(transport, numbers<2>, reply);
      break;
    }
    case 12: { // device_read: link, most bytes, timeouts, flags, terminator
      svc_getargs(transport, (read_parameters<5, false>), static_cast<char*>(raw));
      ++reads;
      send_piece(transport, static_cast<std::size_t>(parameters.numbers[1]));
      return;
    }
    case 23: { // destroy_link
      svc_getargs(transport, (read_parameters<1, false>), static_cast<char*>(raw));
      --links;
      std::int32_t reply[1] = {0};
      answer_with(transport, numbers<1>, reply);
      break;
    }
    default:
      svcerr_noproc(transport);
    }
    std::free(parameters.text);
  }

  template <int count>
  static bool_t numbers(XDR* xdr, void* value) {
    auto* first = static_cast<std::int32_t*>(value);
    for (int i = 0; i < count; ++i) {
      if (xdr_int32_t(xdr, first + i) == 0) {
        return 0;
      }
    }
    return 1;
  }

  struct ReadReply {
    std::int32_t error = 0;
    std::int32_t reason = 0;
    std::string data;
  };

  void send_piece(SVCXPRT* transport, std::size_t most) {
    ReadReply reply{waiting_.empty() ? io_timeout : 0, 0,
                    waiting_.substr(0, std::min(most, piece_bytes_))};
    waiting_.erase(0, reply.data.size());
    reply.reason = waiting_.empty() && reply.error == 0 ? end_of_answer : 0;
    answer_with(
        transport,
        [](XDR* xdr, void* value) -> bool_t {
          auto* read = static_cast<ReadReply*>(value);
          char* data = read->data.data();
          auto size = static_cast<u_int>(read->data.size());
          return xdr_int32_t(xdr, &read->error) != 0 && xdr_int32_t(xdr, &read->reason) != 0 &&
                         xdr_bytes(xdr, &data, &size, size) != 0
                     ? 1
                     : 0;
        },
        &reply);
  }

  Answer answer_;
  std::size_t piece_bytes_;
  std::string waiting_; // to be read
  std::uint16_t core_port_ = 0;
  SVCXPRT* core_ = nullptr;
  SVCXPRT* mapper_tcp_ = nullptr;
  SVCXPRT* mapper_udp_ = nullptr;
  std::jthread thread_;
};

} // namespace dyncal::drivers
