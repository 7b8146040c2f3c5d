#include "services/bus/participant_security.hpp"

#include <utility>

#include "services/bus/adapters.hpp"
#include "services/bus/vendor.hpp"

namespace dyncal::bus {
namespace {

// Passes over what revoked participants write: no vendor looks at the list again once it has
// authenticated them.
class SecuredReader : public UntypedReader {
public:
  SecuredReader(std::unique_ptr<UntypedReader> reader, std::shared_ptr<const IsRevoked> is_revoked)
      : reader_(std::move(reader)), is_revoked_(std::move(is_revoked)) {}

  std::size_t take(const Consume& consume) override {
    std::size_t passed_over = 0;
    const std::size_t taken =
        reader_->take([&](const void* sample, std::string_view bytes, const WriterId& writer) {
          if ((*is_revoked_)(writer)) {
            ++passed_over;
          } else {
            consume(sample, bytes, writer);
          }
        });
    return taken - passed_over;
  }
  [[nodiscard]] int matched_writers() const override { return reader_->matched_writers(); }

private:
  std::unique_ptr<UntypedReader> reader_;
  std::shared_ptr<const IsRevoked> is_revoked_;
};

// Says why the vendor may have refused a writer or reader, which it does not say itself.
class ScreenedParticipant : public UntypedParticipant {
public:
  ScreenedParticipant(std::shared_ptr<UntypedParticipant> participant,
                      const std::filesystem::path& permissions, IsRevoked is_revoked)
      : participant_(std::move(participant)), permissions_(permissions.string()),
        is_revoked_(std::make_shared<const IsRevoked>(std::move(is_revoked))) {}

  base::Expected<std::unique_ptr<UntypedWriter>>
  writer(const TypeSupport& type, const std::string& topic, Profile profile,
         const std::vector<std::string>& partitions) override {
    return participant_->writer(type, topic, profile, partitions)
        .map_error([&](const base::Error& error) {
          return explained(error, "write", topic, partitions.front());
        });
  }

  base::Expected<std::unique_ptr<UntypedReader>> reader(const TypeSupport& type,
                                                        const std::string& topic, Profile profile,
                                                        const std::string& partition,
                                                        std::shared_ptr<WakeUp> wake_up) override {
    return participant_->reader(type, topic, profile, partition, std::move(wake_up))
        .map([&](auto reader) -> std::unique_ptr<UntypedReader> {
          return std::make_unique<SecuredReader>(std::move(reader), is_revoked_);
        })
        .map_error(
            [&](const base::Error& error) { return explained(error, "read", topic, partition); });
  }

  [[nodiscard]] std::uint64_t malformed_messages() const override {
    return participant_->malformed_messages();
  }
  [[nodiscard]] std::shared_ptr<const RefusedPackets> refused_packets() const override {
    return participant_->refused_packets();
  }
  [[nodiscard]] std::shared_ptr<const OwnAddresses> own_addresses() const override {
    return participant_->own_addresses();
  }
  [[nodiscard]] Discovery discovered() const override { return participant_->discovered(); }

private:
  [[nodiscard]] base::Error explained(const base::Error& error, const std::string& verb,
                                      const std::string& topic,
                                      const std::string& partition) const {
    return {error.code, error.message + "; does " + permissions_ + " permit to " + verb + " " +
                            topic + " of bench '" + partition +
                            "'? It is made for a role and its benches by 'dyncal security issue'"};
  }

  std::shared_ptr<UntypedParticipant> participant_;
  std::string permissions_;
  std::shared_ptr<const IsRevoked> is_revoked_;
};

} // namespace

base::Expected<SecuredParticipant> create_secured_participant(const ParticipantOptions& options,
                                                              const SecurityFiles& files,
                                                              IsRevoked is_revoked) {
  DYNCAL_TRY(auto untyped, create_untyped_participant(options, &files));
  const std::shared_ptr<UntypedParticipant> shared = std::move(untyped);
  return SecuredParticipant{Participant(std::make_unique<ScreenedParticipant>(
                                shared, files.permissions, std::move(is_revoked))),
                            [weak = std::weak_ptr(shared)] {
                              const auto participant = weak.lock();
                              return participant ? participant->discovered() : Discovery();
                            }};
}

bool needs_high_subject(Vendor vendor) {
  return vendor == Vendor::fast_dds;
}

bool speaks_alone_when_secured(Vendor vendor) {
#if defined(DYNCAL_HAVE_FAST_DDS) && __has_include(<fastdds/LibrarySettings.hpp>)
  return vendor == Vendor::fast_dds; // version 3, as in fastdds/fast_dds_names.hpp
#else
  static_cast<void>(vendor);
  return false;
#endif
}

std::optional<std::string> what_security_lacks(Vendor vendor) {
#ifdef DYNCAL_HAVE_CYCLONE_DDS
  if (vendor == Vendor::cyclone_dds) {
    return what_cyclone_dds_security_lacks();
  }
#endif
  static_cast<void>(vendor); // Fast DDS has it in its own library
  return std::nullopt;
}

} // namespace dyncal::bus
