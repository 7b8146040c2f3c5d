// A conversation with one instrument in SCPI: commands that are asked for their outcome, queries,
// blocks of definite length.
//
// Messages name the instrument ("oscilloscope 10.0.0.7:5555") and the command. An error that the
// instrument reports (:SYSTem:ERRor?) is passed on as it is (refused); the connection stays.
//
// A query without an answer (timeout), an answer to nothing, or a block of another length than it
// announces (malformed) mean that question and answer no longer belong together. Such a connection
// fails, and lost() is true from then on: its owner reconnects, because talking on would mistake
// one answer for another. It is closed at once, so that no command of it arrives later.
//
// One thread at a time.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/link/scpi_transport.hpp"
#include "drivers/link/stop_signal.hpp"

namespace dyncal::drivers {

class ScpiConnection {
public:
  // `instrument`: "oscilloscope", "generator"; `answer_limit`: how long one answer may take. `stop`
  // outlives the connection.
  [[nodiscard]] static Expected<ScpiConnection>
  connect(std::string instrument, std::string address, std::chrono::milliseconds answer_limit,
          const StopSignal& stop,
          std::chrono::milliseconds connect_limit = std::chrono::milliseconds(5000));
  ScpiConnection(std::string instrument, std::string address,
                 std::chrono::milliseconds answer_limit, std::unique_ptr<ScpiTransport> transport);

  // Sends the command and asks for its outcome: refused when the instrument reports an error.
  // `block`: bytes that follow the text at once, and that messages do not repeat.
  [[nodiscard]] Expected<void> command(const std::string& text, std::string_view block = {});
  [[nodiscard]] Expected<std::string> query(const std::string& text);
  [[nodiscard]] Expected<double> query_number(const std::string& text);
  // The bytes of the block that answers; a block of more than `max_bytes` is malformed.
  [[nodiscard]] Expected<std::vector<char>> query_block(const std::string& text,
                                                        std::size_t max_bytes);
  // Sends the command and asks for nothing: before the instrument is known to listen, or to end an
  // activity.
  [[nodiscard]] Expected<void> send(const std::string& text, std::string_view block = {});

  // Called twice a second while an answer lets wait, where the transport can do that (TCP), so that
  // a caller who waits long does not neglect everything else; returns false to wait no longer.
  void call_while_waiting(std::function<bool()> callback) { while_waiting_ = std::move(callback); }
  void set_answer_limit(std::chrono::milliseconds limit) { answer_limit_ = limit; }
  // For an instrument that moves something: a command that has not arrived by then never does.
  void set_delivery_limit(std::chrono::milliseconds limit) {
    transport_->set_delivery_limit(limit);
  }

  [[nodiscard]] bool lost() const { return lost_; }
  [[nodiscard]] const std::string& address() const { return address_; }

private:
  Expected<std::vector<char>> read_block(std::size_t max_bytes);
  Expected<void> ask(const std::string& query);
  Expected<std::string> read_answer();
  // The connection is lost from now on. `message` of the transport begins with the address.
  tl::unexpected<Error> give_up(const Error& error, const std::string& command);
  tl::unexpected<Error> give_up_misunderstood(const std::string& reason,
                                              const std::string& command);

  std::string instrument_;
  std::string address_;
  std::chrono::milliseconds answer_limit_;
  std::unique_ptr<ScpiTransport> transport_;
  std::function<bool()> while_waiting_;
  bool lost_ = false;
};

} // namespace dyncal::drivers
