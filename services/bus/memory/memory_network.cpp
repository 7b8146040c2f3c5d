#include "services/bus/memory/memory_network.hpp"

#include <random>

#include "services/bus/cdr_key.hpp"
#include "services/bus/default_partition.hpp"
#include "services/bus/malformed_messages.hpp"
#include "services/bus/memory/memory_exchange.hpp"

namespace dyncal::bus {
namespace {

class MemoryWriter : public UntypedWriter {
public:
  MemoryWriter(std::shared_ptr<MemoryExchange> exchange, const TypeSupport& type,
               MemoryEndpoint endpoint)
      : exchange_(std::move(exchange)), type_(type),
        state_(exchange_->open_writer(std::move(endpoint))) {}
  ~MemoryWriter() override { exchange_->close(state_); }

  WriteOutcome write(const EncodedMessage& payload, std::chrono::nanoseconds limit) override {
    const auto key = read_key(type_.key, payload->data(), payload->size());
    if (!key) {
      return WriteOutcome::failed;
    }
    MemoryMessage message;
    message.key = canonical_key(*key);
    message.payload = payload;
    const auto written = wait_until(limit, [&] { return exchange_->write(*state_, message); });
    return written ? WriteOutcome::written : WriteOutcome::timed_out;
  }

  [[nodiscard]] int matched_readers() const override { return exchange_->matched_readers(*state_); }

  bool wait_for_acknowledgments(std::chrono::nanoseconds limit) override {
    return wait_until(limit, [&] { return exchange_->all_acknowledged(*state_); });
  }

private:
  template <class Condition>
  bool wait_until(std::chrono::nanoseconds limit, Condition&& condition) {
    Clock& clock = exchange_->clock();
    const auto deadline = clock.now() + limit;
    while (!condition()) {
      if (clock.now() >= deadline) {
        return false;
      }
      clock.wait(*state_->wake_up, deadline);
    }
    return true;
  }

  std::shared_ptr<MemoryExchange> exchange_;
  const TypeSupport& type_;
  std::shared_ptr<MemoryWriterState> state_;
};

class MemoryReader : public UntypedReader {
public:
  MemoryReader(std::shared_ptr<MemoryExchange> exchange, const TypeSupport& type,
               MemoryEndpoint endpoint, std::shared_ptr<MalformedMessages> malformed)
      : exchange_(std::move(exchange)), type_(type), malformed_(std::move(malformed)),
        sample_(type.create(), type.destroy), state_(exchange_->open_reader(std::move(endpoint))) {}
  ~MemoryReader() override { exchange_->close(state_); }

  std::size_t take(const Consume& consume) override {
    std::size_t taken = 0;
    while (const auto message = exchange_->take_next(*state_)) {
      if (!decode(*message->payload)) {
        malformed_->add(type_.name);
        continue;
      }
      ++taken;
      consume(sample_.get(), *message->payload, message->writer);
    }
    return taken;
  }

  [[nodiscard]] int matched_writers() const override { return exchange_->matched_writers(*state_); }

private:
  // A payload of key members alone leaves the others zero.
  [[nodiscard]] bool decode(const std::string& payload) {
    return read_key(type_.key, payload.data(), payload.size()) &&
           type_.deserialize(sample_.get(), payload.data(), payload.size());
  }

  std::shared_ptr<MemoryExchange> exchange_;
  const TypeSupport& type_;
  std::shared_ptr<MalformedMessages> malformed_;
  std::unique_ptr<void, void (*)(void*)> sample_;
  std::shared_ptr<MemoryReaderState> state_;
};

class MemoryParticipant : public UntypedParticipant {
public:
  MemoryParticipant(std::shared_ptr<MemoryExchange> exchange, std::string name,
                    std::function<void(const std::string&)> warn)
      : exchange_(std::move(exchange)), name_(std::move(name)), number_(exchange_->join(name_)),
        malformed_(std::make_shared<MalformedMessages>(std::move(warn))) {}

  base::Expected<std::unique_ptr<UntypedWriter>>
  writer(const TypeSupport& type, const std::string& topic, Profile profile,
         const std::vector<std::string>& partitions) override {
    return std::make_unique<MemoryWriter>(exchange_, type,
                                          endpoint(type, topic, qos_of_writer(profile),
                                                   partitions_of_writer(profile, false, partitions),
                                                   std::make_shared<WakeUp>()));
  }

  base::Expected<std::unique_ptr<UntypedReader>> reader(const TypeSupport& type,
                                                        const std::string& topic, Profile profile,
                                                        const std::string& partition,
                                                        std::shared_ptr<WakeUp> wake_up) override {
    return std::make_unique<MemoryReader>(
        exchange_, type,
        endpoint(type, topic, qos_of_reader(profile), {partition}, std::move(wake_up)), malformed_);
  }

  [[nodiscard]] std::uint64_t malformed_messages() const override { return malformed_->count(); }
  [[nodiscard]] Discovery discovered() const override { return exchange_->discovered(number_); }

private:
  [[nodiscard]] MemoryEndpoint endpoint(const TypeSupport& type, const std::string& topic,
                                        const EndpointQos& qos, std::vector<std::string> partitions,
                                        std::shared_ptr<WakeUp> wake_up) const {
    return {.topic = topic,
            .type_name = type.name,
            .partitions = std::move(partitions),
            .participant = name_,
            .participant_number = number_,
            .qos = qos,
            .wake_up = std::move(wake_up)};
  }

  std::shared_ptr<MemoryExchange> exchange_;
  std::string name_;
  std::uint32_t number_;
  std::shared_ptr<MalformedMessages> malformed_;
};

} // namespace

MemoryNetwork::MemoryNetwork(Clock& clock)
    : exchange_(std::make_shared<MemoryExchange>(clock, nullptr)) {}

MemoryNetwork::MemoryNetwork(SteppedClock& clock)
    : exchange_(std::make_shared<MemoryExchange>(clock, &clock)) {}

Participant MemoryNetwork::join(std::string name, std::function<void(const std::string&)> warn) {
  return Participant(
      std::make_unique<MemoryParticipant>(exchange_, std::move(name), std::move(warn)));
}

void MemoryNetwork::lose(Rule rule) {
  exchange_->lose(std::move(rule));
}

void MemoryNetwork::lose_randomly(double probability, std::uint64_t seed) {
  exchange_->lose([probability, random = std::mt19937_64(seed)](const MessageInTransit&) mutable {
    return std::generate_canonical<double, 53>(random) < probability;
  });
}

void MemoryNetwork::delay(Delay delay) {
  exchange_->delay(std::move(delay));
}

void MemoryNetwork::stop_reading(const std::string& participant) {
  exchange_->set_stopped(participant, true);
}

void MemoryNetwork::resume_reading(const std::string& participant) {
  exchange_->set_stopped(participant, false);
}

void MemoryNetwork::fill_writers(const std::string& topic) {
  exchange_->set_full(topic, true);
}

void MemoryNetwork::empty_writers(const std::string& topic) {
  exchange_->set_full(topic, false);
}

void MemoryNetwork::inject(const std::string& topic, const std::string& partition,
                           std::string payload) {
  exchange_->inject(topic, partition, std::move(payload));
}

} // namespace dyncal::bus
