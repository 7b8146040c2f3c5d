"""Settings that several classes of calibrations share, and how a class is made of them."""

from bench_settings import BenchSettings

LOW_FREQUENCIES = {
    "frequencies": ("0.40", "0.41", "0.42", "0.43"),
    "duration_s": 7.5,  # three periods
    "pause_s": 6.0,
    # No multiples of the mains frequencies, which they would fold onto the excitation.
    "acs_rate_hz": 512.0,
    "sensor_rate_hz": 256.0,
}
# What is left of other uncertainties must not hide an error of some 1e-3.
LITTLE_NOISE = {
    "sensor_noise_rel": 0.002,
    "reference_noise_rel": 0.001,
    "u_reference_magnitude_rel": 1e-4,
    "u_reference_phase_rad": 1e-4,
    "u_adc_lag_rad": 3e-5,
}
HARDLY_ANY_NOISE = {
    "generator_error_rel": 2e-4,
    "acs_rate_error_rel": 0.0,
    "harmonics_rel": (),
    "sensor_noise_rel": 1e-5,
    "reference_noise_rel": 1e-5,
    "sync_noise_rel": 1e-5,
    "trace_noise_v": 5e-5,
    "dso_rate_rel": 0.0,
    "trace_step_v": 1e-6,
    "u_reference_magnitude_rel": 3e-7,
    "u_reference_phase_rad": 3e-7,
    "u_acs_delay_s": 1e-10,
}
SHORT_ANALOGUE_STEPS = {
    "method": "analogue",
    # Not 50 Hz, nor 125 Hz, whose orders 7 and 9 fold onto it when 1000 samples are taken a second:
    # the bounds of such lines would hide what is drawn here.
    "frequencies": ("12.5", "20", "31.5", "40", "80", "128"),
    "acs_rate_hz": 1000.0,
    "duration_s": 0.5,
    "u_reference_magnitude_rel": 1e-4,
    "u_reference_phase_rad": 1e-4,
}
SERIES = {
    "method": "series-timestamping",
    "frequencies": ("20", "40", "80", "128", "160", "210"),  # nothing folds onto them
    "duration_s": 0.6,
}
RUN_SCATTER_REL = 2e-3  # three times what the fit knows of one short analogue step

# Beside the mains, where 1 / T is 0.67 Hz.
AT_50_HZ = ("49.97", "49.98", "49.99", "50.00", "50.01", "50.02")
BESIDE_50_HZ = ("49.7", "49.8", "49.9", "50.1", "50.2", "50.3")
BESIDE_60_HZ = ("59.7", "59.8", "59.9", "60.1", "60.2", "60.3")


def bench(*parts, **more):
    settings = {}
    for part in parts:
        settings.update(part)
    return BenchSettings(**{**settings, **more})
