#include "drivers/virtual_bench/wire/bench_server.hpp"

#include <algorithm>

#include <poll.h>
#include <sys/socket.h>

#include "drivers/virtual_bench/wire/receive_queue.hpp"
#include "drivers/virtual_bench/wire/server_socket.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

using std::chrono::milliseconds;

constexpr double description_interval_s = 4.0;
constexpr double min_slice_s = 0.004; // of bench time, unless somebody waits for an instant before
constexpr double max_slice_s = 0.02;
constexpr double max_arrears_s = 0.5; // host time that is made up for after a delay
constexpr double frame_s = 0.05;
constexpr double max_frame_samples = 32768.0; // what one slice adds stays below the stream's limit
constexpr double max_backlog_s = 0.1;
constexpr double datagram_burst = 32.0;
constexpr std::size_t max_receive_queue =
    std::size_t{64} * 1024; // of the 208 KiB that hosts allow at least
// Between two looks at a receive buffer: the kernel walks over the table of all its sockets for
// one.
constexpr std::chrono::microseconds min_look_interval{2000};
constexpr std::chrono::microseconds real_time_look_interval{20'000};
constexpr milliseconds idle_wait{4};
constexpr milliseconds blocked_wait{20};

// What the kernel counts for a datagram that waits: room of the next power of two, and what it
// knows of it.
std::size_t most_counted_bytes(std::size_t datagram_bytes) {
  return 2 * datagram_bytes + 1024;
}

// A buffer fills as much faster as the bench is faster than real time.
std::chrono::microseconds look_interval(const ServerSettings& settings, bool follows_utc) {
  if (follows_utc) {
    return real_time_look_interval;
  }
  if (settings.speed <= 0.0) {
    return min_look_interval;
  }
  const auto in_proportion = std::chrono::duration_cast<std::chrono::microseconds>(
      real_time_look_interval / settings.speed);
  return std::clamp(in_proportion, min_look_interval, real_time_look_interval);
}

} // namespace

BenchServer::BenchServer(VirtualBench& bench, const ServerSettings& settings)
    : bench_(bench), settings_(settings), instrument_(bench), generator_clients_(instrument_),
      packer_(settings.sensor_id, bench.settings().preset.sensor_name, settings.with_ticks),
      path_(bench.settings().seed, settings.path,
            [this](const std::string& datagram) { send_datagram(datagram); }),
      receiver_on_this_host_(is_loopback(settings.dau.host)),
      queue_look_interval_(look_interval(settings, bench.settings().utc_origin_ns.has_value())) {
  if (settings.triggered) {
    triggered_.emplace(*settings.triggered);
  }
}

Expected<void> BenchServer::open() {
  auto acs = listen_tcp(settings_.acs_listen);
  auto generator = listen_tcp(settings_.generator_listen);
  auto unit = connect_udp(settings_.dau);
  for (const auto* opened : {&acs, &generator, &unit}) {
    DYNCAL_TRY(*opened);
  }
  if (triggered_) {
    if (auto done = triggered_->open(); !done) {
      return done;
    }
  }
  acs_listener_ = std::move(*acs);
  generator_listener_ = std::move(*generator);
  unit_socket_ = std::move(*unit);
  return {};
}

std::uint16_t BenchServer::acs_port() const {
  return local_port(acs_listener_);
}
std::uint16_t BenchServer::generator_port() const {
  return local_port(generator_listener_);
}

void BenchServer::run(const StopSignal& stop) {
  hold_pace();
  credit_at_ = Clock::now();
  while (!stop.raised() && (settings_.duration_s <= 0.0 || bench_.now_s() < settings_.duration_s)) {
    serve_sockets();
    const double time_s = allowed_time_s();
    if (time_s > bench_.now_s()) {
      advance_to(time_s);
    } else {
      const bool is_stream_full =
          stream_.backlog_bytes() > 0 && may_wait_bytes_ <= max_receive_queue;
      wait_for_events(stop, is_stream_full ? blocked_wait : idle_wait);
    }
  }
  end_stream(stop);
  generator_clients_.close_all();
}

void BenchServer::serve_sockets() {
  if (FileDescriptor client = accept_client(acs_listener_);
      client.is_open() && !stream_.connected()) {
    stream_.connect(std::move(client), bench_.acs().description_line());
    frame_.counts.clear();
  }
  if (FileDescriptor client = accept_client(generator_listener_); client.is_open()) {
    generator_clients_.add(std::move(client));
  }
  stream_.serve();
  generator_clients_.serve(bench_.now_s());
  if (triggered_) {
    triggered_->serve();
  }
}

void BenchServer::wait_for_events(const StopSignal& stop, milliseconds limit) const {
  std::vector<pollfd> watched{{stop.descriptor(), POLLIN, 0},
                              {acs_listener_.number(), POLLIN, 0},
                              {generator_listener_.number(), POLLIN, 0}};
  if (stream_.connected()) {
    watched.push_back({stream_.descriptor(),
                       static_cast<short>(stream_.backlog_bytes() > 0 ? POLLIN | POLLOUT : POLLIN),
                       0});
  }
  for (const int descriptor : generator_clients_.descriptors()) {
    watched.push_back({descriptor, POLLIN, 0});
  }
  if (triggered_) {
    for (const int descriptor : triggered_->descriptors()) {
      watched.push_back({descriptor, POLLIN, 0});
    }
    limit = triggered_->has_backlog() ? milliseconds(1) : limit;
  }
  poll(watched.data(), watched.size(), static_cast<int>(limit.count()));
}

bool BenchServer::consumers_keep_up() {
  const auto now = Clock::now();
  const double passed_s = std::chrono::duration<double>(now - credit_at_).count();
  datagram_credit_ =
      std::min(datagram_burst, datagram_credit_ + passed_s * settings_.datagrams_per_s);
  credit_at_ = now;
  const double backlog_limit = max_backlog_s * static_cast<double>(bench_.settings().acs_rate_hz) *
                               static_cast<double>(bench_.acs().channels().size()) *
                               sizeof(std::int32_t);
  return datagram_credit_ > 0.0 && datagrams_are_taken() &&
         static_cast<double>(stream_.backlog_bytes()) <= backlog_limit;
}

bool BenchServer::datagrams_are_taken() {
  const auto now = Clock::now();
  if (receiver_on_this_host_ && may_wait_bytes_ > max_receive_queue &&
      now - queue_looked_at_ >= queue_look_interval_) {
    queue_looked_at_ = now;
    may_wait_bytes_ = udp_receive_queue(settings_.dau.port);
  }
  return may_wait_bytes_ <= max_receive_queue;
}

void BenchServer::hold_pace() {
  pace_host_ = Clock::now();
  pace_bench_s_ = bench_.now_s();
}

double BenchServer::paced_time_s() {
  if (bench_.settings().utc_origin_ns) {
    const auto utc = std::chrono::system_clock::now().time_since_epoch() -
                     std::chrono::nanoseconds(*bench_.settings().utc_origin_ns);
    return std::chrono::duration<double>(utc).count() + settings_.utc_lead_s;
  }
  const double speed = settings_.speed > 0.0 ? settings_.speed : 1.0;
  const double time_s =
      pace_bench_s_ + speed * std::chrono::duration<double>(Clock::now() - pace_host_).count();
  if (time_s > bench_.now_s() + speed * max_arrears_s) {
    hold_pace();
  }
  return time_s;
}

double BenchServer::allowed_time_s() {
  const double now_s = bench_.now_s();
  if (!consumers_keep_up()) {
    hold_pace();
    return now_s;
  }
  const auto wait_s = generator_clients_.earliest_wait_s();
  double time_s = now_s;
  if (settings_.speed <= 0.0 && !bench_.settings().utc_origin_ns && wait_s && stream_.connected()) {
    hold_pace();
    time_s = now_s + max_slice_s;
  } else {
    time_s = std::min(paced_time_s(), now_s + max_slice_s);
  }
  if (settings_.duration_s > 0.0) {
    time_s = std::min(time_s, settings_.duration_s);
  }
  if (wait_s && *wait_s <= time_s) {
    return std::max(*wait_s, now_s);
  }
  return time_s >= now_s + min_slice_s || time_s == settings_.duration_s ? time_s : now_s;
}

void BenchServer::advance_to(double time_s) {
  bench_.advance_to(time_s, frame_, [this](const UnitSample& sample) {
    if (const auto datagram = packer_.append(sample)) {
      path_.send(*datagram);
    }
  });
  if (triggered_) {
    triggered_->advance_to(time_s, bench_.excitation());
  }
  if (settings_.after_advance) {
    settings_.after_advance(time_s);
  }
  if (settings_.with_samples) {
    settings_.with_samples(frame_);
  }
  while (bench_.now_s() >= next_description_s_) {
    for (const std::string& datagram : packer_.descriptions(bench_.unit().channels())) {
      path_.send(datagram);
    }
    next_description_s_ += description_interval_s;
  }
  if (!stream_.connected()) {
    frame_.counts.clear();
  } else if (static_cast<double>(frame_.samples()) >=
             std::min(frame_s * static_cast<double>(bench_.settings().acs_rate_hz),
                      max_frame_samples)) {
    send_frame();
  }
}

void BenchServer::send_frame() {
  if (bench_.acs().sends(frame_)) {
    stream_.send_frame(frame_);
  }
  frame_.counts.clear();
}

void BenchServer::send_datagram(const std::string& datagram) {
  datagram_credit_ -= 1.0;
  may_wait_bytes_ += most_counted_bytes(datagram.size());
  // Nobody there, or no room at the receiver: the unit does not learn of it either.
  static_cast<void>(send(unit_socket_.number(), datagram.data(), datagram.size(), MSG_NOSIGNAL));
}

// The rest of the stream and its end, as far as the client takes them within two seconds.
void BenchServer::end_stream(const StopSignal& stop) {
  if (!stream_.connected() || stop.raised()) {
    return;
  }
  send_frame();
  stream_.send_end();
  const auto deadline = Clock::now() + std::chrono::seconds(2);
  while (stream_.backlog_bytes() > 0 && stream_.connected() && Clock::now() < deadline &&
         !stop.raised()) {
    stream_.serve();
    wait_for_events(stop, blocked_wait);
  }
}

} // namespace dyncal::drivers::virtual_bench
