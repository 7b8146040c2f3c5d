#include "drivers/alsa/alsa_device.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>
#include <vector>

#include <alsa/asoundlib.h>
#include <poll.h>

namespace dyncal::drivers::alsa {
namespace {

constexpr unsigned period_us = 50'000;
constexpr unsigned buffer_us = 1'000'000;

snd_pcm_format_t alsa_format(SampleFormat format) {
  switch (format) {
  case SampleFormat::s16:
    return SND_PCM_FORMAT_S16_LE;
  case SampleFormat::s24:
    return SND_PCM_FORMAT_S24_LE;
  case SampleFormat::s24_3le:
    return SND_PCM_FORMAT_S24_3LE;
  case SampleFormat::s32:
    return SND_PCM_FORMAT_S32_LE;
  case SampleFormat::float32:
    break;
  }
  return SND_PCM_FORMAT_FLOAT_LE;
}

class AlsaDevice : public CaptureDevice {
public:
  AlsaDevice(DeviceSettings settings, const StopSignal& stop)
      : settings_(std::move(settings)), stop_(stop) {}

  [[nodiscard]] Expected<Instant> open() override;
  [[nodiscard]] Expected<Instant> restart() override;
  [[nodiscard]] Captured read(std::span<std::byte> room) override;
  [[nodiscard]] std::string name() const override { return name_; }

private:
  struct Close {
    void operator()(snd_pcm_t* pcm) const { snd_pcm_close(pcm); }
  };
  [[nodiscard]] tl::unexpected<Error> failed(ErrorCode code, const std::string& what,
                                             int status) const {
    return fail(code, settings_.device + ": " + what + ": " + snd_strerror(status));
  }
  [[nodiscard]] Expected<void> configure();
  [[nodiscard]] Captured after(int status) const;
  [[nodiscard]] bool wait(); // false: stopped

  DeviceSettings settings_;
  const StopSignal& stop_;
  std::unique_ptr<snd_pcm_t, Close> pcm_;
  std::string name_;
};

// ALSA's own lines on standard error say less than what its functions return.
void be_quiet(const char*, int, const char*, int, const char*, ...) {}

Expected<void> AlsaDevice::configure() {
  snd_pcm_hw_params_t* wanted = nullptr;
  snd_pcm_hw_params_alloca(&wanted);
  snd_pcm_t* const pcm = pcm_.get();
  if (const int status = snd_pcm_hw_params_any(pcm, wanted); status < 0) {
    return failed(ErrorCode::invalid_setting, "has no configuration", status);
  }
  snd_pcm_hw_params_set_rate_resample(pcm, wanted, 0);
  const struct {
    int status;
    const char* what;
  } steps[] = {{snd_pcm_hw_params_set_access(pcm, wanted, SND_PCM_ACCESS_RW_INTERLEAVED),
                "does not give its channels side by side"},
               {snd_pcm_hw_params_set_format(pcm, wanted, alsa_format(settings_.format)),
                "does not have the format of the bench file"},
               {snd_pcm_hw_params_set_channels(pcm, wanted, settings_.channels),
                "does not have the bench file's number of channels"},
               {snd_pcm_hw_params_set_rate(pcm, wanted, settings_.rate_hz, 0),
                "does not have the rate_hz of the bench file"}};
  for (const auto& [status, what] : steps) {
    if (status < 0) {
      return failed(ErrorCode::invalid_setting, what, status);
    }
  }
  unsigned period = period_us;
  unsigned buffer = buffer_us;
  snd_pcm_hw_params_set_buffer_time_near(pcm, wanted, &buffer, nullptr); // as it can
  snd_pcm_hw_params_set_period_time_near(pcm, wanted, &period, nullptr);
  const int status = snd_pcm_hw_params(pcm, wanted);
  return status < 0 ? failed(ErrorCode::invalid_setting, "cannot be set up", status)
                    : Expected<void>{};
}

Expected<Instant> AlsaDevice::open() {
  snd_lib_error_set_handler(be_quiet);
  pcm_.reset();
  snd_pcm_t* pcm = nullptr;
  const int status =
      snd_pcm_open(&pcm, settings_.device.c_str(), SND_PCM_STREAM_CAPTURE, SND_PCM_NONBLOCK);
  if (status < 0) {
    return failed(status == -EBUSY ? ErrorCode::refused : ErrorCode::not_found,
                  "cannot be opened for capture (arecord -L lists devices)", status);
  }
  pcm_.reset(pcm);
  DYNCAL_TRY(configure());
  snd_pcm_info_t* info = nullptr;
  snd_pcm_info_alloca(&info);
  name_ = snd_pcm_info(pcm, info) == 0 ? snd_pcm_info_get_name(info) : "";
  return restart();
}

Expected<Instant> AlsaDevice::restart() {
  int status = snd_pcm_prepare(pcm_.get());
  status = status < 0 ? status : snd_pcm_start(pcm_.get());
  if (status < 0) {
    return failed(ErrorCode::disconnected, "cannot be started", status);
  }
  return std::chrono::steady_clock::now();
}

bool AlsaDevice::wait() {
  const auto own = static_cast<unsigned>(std::max(0, snd_pcm_poll_descriptors_count(pcm_.get())));
  std::vector<pollfd> waited(own);
  snd_pcm_poll_descriptors(pcm_.get(), waited.data(), own);
  waited.push_back({stop_.descriptor(), POLLIN, 0});
  ::poll(waited.data(), waited.size(), -1);
  unsigned short events = 0; // which a plugin takes back, so that it can wait for others
  snd_pcm_poll_descriptors_revents(pcm_.get(), waited.data(), own, &events);
  return !stop_.raised();
}

Captured AlsaDevice::after(int status) const {
  if (status == -EPIPE || status == -ESTRPIPE) {
    return {.event = CaptureEvent::overrun};
  }
  return {.event = CaptureEvent::gone,
          .problem = settings_.device + ": is gone: " + snd_strerror(status)};
}

Captured AlsaDevice::read(std::span<std::byte> room) {
  const std::size_t frame_bytes = bytes_of(settings_.format) * settings_.channels;
  for (;;) {
    if (!wait()) {
      return {.event = CaptureEvent::stopped};
    }
    const snd_pcm_sframes_t frames =
        snd_pcm_readi(pcm_.get(), room.data(), room.size() / frame_bytes);
    if (frames == -EAGAIN || frames == -EINTR) {
      if (snd_pcm_state(pcm_.get()) == SND_PCM_STATE_DISCONNECTED) {
        return after(-ENODEV);
      }
      continue;
    }
    if (frames < 0) {
      return after(static_cast<int>(frames));
    }
    const snd_pcm_sframes_t waiting = snd_pcm_avail_update(pcm_.get());
    return {.event = CaptureEvent::frames,
            .frames = static_cast<std::size_t>(frames),
            .waiting = static_cast<std::size_t>(std::max<snd_pcm_sframes_t>(0, waiting)),
            .at = std::chrono::steady_clock::now()};
  }
}

} // namespace

std::unique_ptr<CaptureDevice> make_alsa_device(DeviceSettings settings, const StopSignal& stop) {
  return std::make_unique<AlsaDevice>(std::move(settings), stop);
}

} // namespace dyncal::drivers::alsa
