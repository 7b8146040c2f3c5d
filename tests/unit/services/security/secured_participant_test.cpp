// Participants of a secured laboratory over two vendors: who is permitted finds the
// others, and who is not is told why.
#include <algorithm>
#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/base/version.hpp"
#include "services/bus/participant_security.hpp"
#include "services/contract/topics.hpp"
#include "services/security/identity_folder.hpp"
#include "services/security/laboratory_authority.hpp"
#include "services/security/pem_file.hpp"
#include "services/security/revoked_participants.hpp"
#include "tests/dds_domain.hpp"
#include "tests/patience.hpp"
#include "tests/temporary_folder.hpp"

namespace dyncal {
namespace {

using testing::HasSubstr;

struct Pair {
  bus::Vendor writer;
  bus::Vendor reader;
};

std::vector<Pair> all_pairs() {
  std::vector<Pair> pairs;
  for (const bus::Vendor writer : bus::vendors_in_this_build()) {
    for (const bus::Vendor reader : bus::vendors_in_this_build()) {
      if (writer != reader) { // two in one process share permissions in Cyclone DDS
        pairs.push_back({writer, reader});
      }
    }
  }
  return pairs;
}

// Of Debian 13; its handshake with others ends, but its keys never come.
bool speaks_alone_when_secured() {
  return base::build_description().find("fastdds 3.") != std::string::npos;
}

class SecuredParticipants : public testing::TestWithParam<Pair> {
protected:
  void SetUp() override {
    if (speaks_alone_when_secured()) {
      GTEST_SKIP() << "Fast DDS 3 talks to no other secured DDS";
    }
    auto made = LaboratoryAuthority::create(folder.path() / "authority", "Lab");
    ASSERT_TRUE(made) << made.error().message;
    authority.emplace(std::move(*made));
  }
  // Of a certificate made for it.
  bus::Participant participant(bus::Vendor vendor, SecurityRole role,
                               const std::vector<std::string>& benches) {
    IdentityRequest request;
    request.role = role;
    request.benches = benches;
    request.vendors = {vendor};
    const auto output = folder.path() / std::to_string(++folders);
    const auto name = authority->issue(request, output);
    EXPECT_TRUE(name) << name.error().message;
    bus::ParticipantOptions options;
    options.vendor = vendor;
    options.domain = tests::own_dds_domain();
    options.interface_name = "lo";
    const auto files = security_files(output, vendor);
    certificate = files.certificate;
    auto joined = bus::create_secured_participant(
        options, files, [this](const bus::WriterId& writer) { return is_revoked(writer); });
    EXPECT_TRUE(joined) << joined.error().message;
    return std::move(joined->participant);
  }

  bool is_revoked(const bus::WriterId& writer) {
    const bool is_one = revoked && writer.is_known() &&
                        std::equal(revoked->begin(), revoked->end(), writer.guid.begin());
    passed_over += is_one ? 1 : 0;
    return is_one;
  }
  [[nodiscard]] GuidStart guid_start() const {
    const auto certificates = read_certificates(certificate);
    EXPECT_TRUE(certificates);
    return guid_start_of(*X509_get_subject_name(certificates->front().get()));
  }

  std::filesystem::path certificate; // of the last one
  std::optional<GuidStart> revoked;
  int passed_over = 0;
  tests::TemporaryFolder folder;
  std::optional<LaboratoryAuthority> authority;
  int folders = 0;
};

TEST_P(SecuredParticipants, FindEachOtherAndHandOverWhatWasWritten) {
  auto source = participant(GetParam().writer, SecurityRole::source, {"acc-1"});
  auto analysis = participant(GetParam().reader, SecurityRole::analysis, {});
  const auto wake_up = std::make_shared<bus::WakeUp>();
  auto reader = analysis.reader(bus::topics::source_status, "*", wake_up);
  ASSERT_TRUE(reader) << reader.error().message;
  auto writer = source.writer(bus::topics::source_status, "acc-1");
  ASSERT_TRUE(writer) << writer.error().message;
  wire::SourceStatus status;
  status.bench() = "acc-1";
  status.source() = "dau";
  ASSERT_EQ(writer->write(status), bus::WriteOutcome::written);
  const auto deadline = std::chrono::steady_clock::now() + tests::patience;
  std::size_t taken = 0;
  while (taken == 0 && std::chrono::steady_clock::now() < deadline) {
    wake_up->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(100));
    taken = reader->take([](const wire::SourceStatus& one) { EXPECT_EQ(one.source(), "dau"); });
  }
  EXPECT_EQ(taken, 1U);
}

TEST_P(SecuredParticipants, AreKnownByTheSubjectOfTheirCertificateAndLeftOutOnceItIsRevoked) {
  auto source = participant(GetParam().writer, SecurityRole::source, {"acc-1"});
  const GuidStart start = guid_start();
  auto analysis = participant(GetParam().reader, SecurityRole::analysis, {});
  const auto wake_up = std::make_shared<bus::WakeUp>();
  auto reader = analysis.reader(bus::topics::source_status, "*", wake_up).value();
  auto writer = source.writer(bus::topics::source_status, "acc-1").value();
  int taken = 0;
  const auto take_until = [&](const auto& is_over) {
    const auto deadline = std::chrono::steady_clock::now() + tests::patience;
    while (!is_over() && std::chrono::steady_clock::now() < deadline) {
      wake_up->wait_until(std::chrono::steady_clock::now() + std::chrono::milliseconds(100));
      reader.take_with_writer([&](const wire::SourceStatus&, const bus::WriterId& from) {
        EXPECT_TRUE(std::equal(start.begin(), start.end(), from.guid.begin()));
        ++taken;
      });
    }
  };
  wire::SourceStatus status;
  status.bench() = "acc-1";
  status.source() = "dau";
  ASSERT_EQ(writer.write(status), bus::WriteOutcome::written);
  take_until([&] { return taken > 0; });
  EXPECT_EQ(taken, 1);
  revoked = start;
  ASSERT_EQ(writer.write(status), bus::WriteOutcome::written);
  take_until([&] { return passed_over > 0; });
  EXPECT_EQ(passed_over, 1);
  EXPECT_EQ(taken, 1);
}

TEST_P(SecuredParticipants, AreRefusedWhatTheirPermissionsDoNotHaveWithTheReason) {
  auto source = participant(GetParam().writer, SecurityRole::source, {"acc-2"});
  const auto other_bench = source.writer(bus::topics::source_status, "acc-1");
  ASSERT_FALSE(other_bench);
  EXPECT_THAT(other_bench.error().message, HasSubstr("of bench 'acc-1'?"));
  const auto other_topic = source.writer(bus::topics::excitation, "acc-2");
  ASSERT_FALSE(other_topic);
  EXPECT_THAT(other_topic.error().message, HasSubstr("permit to write Excitation"));
  const auto all = source.reader(bus::topics::measurement, "*", std::make_shared<bus::WakeUp>());
  EXPECT_FALSE(all);
}

INSTANTIATE_TEST_SUITE_P(BothWays, SecuredParticipants, testing::ValuesIn(all_pairs()),
                         [](const auto& one) {
                           return bus::to_string(one.param.writer) + "_to_" +
                                  bus::to_string(one.param.reader);
                         });

} // namespace
} // namespace dyncal
