"""What a simulated bench is like, and which faults it has."""

import collections.abc
import dataclasses
import math

from faults.fault import Fault


@dataclasses.dataclass(frozen=True)
class BenchSettings:
    """A clean bench; a class of faults changes some of it. Amplitudes `_rel` are parts of the
    signal's own amplitude, noise is a standard deviation."""

    method: str = "sample-timestamping"
    frequencies: tuple = ("12.5", "31.5", "63", "125", "160", "200")
    level_m_s2: float = 10.0
    repetitions: int = 1
    duration_s: float = 1.5
    settling_s: float = 0.2
    pause_s: float = 0.5  # between steps
    acs_rate_hz: float = 5000.0
    sensor_rate_hz: float = 1003.05
    sensor_rate_scatter_rel: float = 2e-4  # from calibration to calibration
    regular_stamps: bool = False  # exact ones, as a program writes that knows only the rate
    own_clock: bool = False  # the sensor stamps by itself, beside the DAU that records sync
    u_stamp_s: float = 0.0  # of the sensor's clock, stated and drawn for each step; 0: not stated

    generator_error_rel: float = 1e-6  # half width of a rectangle
    acs_rate_error_rel: float = 5e-7
    sensor_noise_rel: float = 0.01
    reference_noise_rel: float = 0.003
    sync_noise_rel: float = 0.001
    harmonics_rel: tuple = (0.001, 0.0005)  # second, third ... of the exciter
    sensor_offset_rel: float = 0.05
    u_reference_magnitude_rel: float = 3e-4
    u_reference_phase_rad: float = 3e-4
    u_adc_lag_rad: float = 1e-4
    u_acs_delay_s: float = 1e-8  # between the channels of the ACS
    sensor_sign: float = 1.0  # -1: mounted upside down
    run_scatter_rel: float = 0.0  # of the sensor from repetition to repetition; phase in rad

    # What a bench file should say and may not.
    states_reference_uncertainty: bool = True
    calibrated_reference: bool = False  # by a table, with its uncertainty, in place of keys
    states_adc_calibration: bool = True
    stated_u_adc_delay_s: float = 0.0  # 0: not stated
    states_dso_rate: bool = True
    sync_acs_channel: str = "sync"

    # Faults.
    level_factor: float = 1.0  # real level to the planned one
    sensor_range_m_s2: float = math.inf
    sensor_range_rel: float = math.inf  # of the signal's amplitude
    reference_range_rel: float = math.inf
    gravity: bool = False  # on the axis
    stuck_samples: int = 0  # in every step
    lost_rel: float = 0.0
    not_measured_rel: float = 0.0
    reference_not_measured_rel: float = 0.0
    records_sample_numbers: bool = True
    disordered_stamps: int = 0  # in every step
    drift_rel: float = 0.0  # over what is evaluated of a step
    resolution_rel: float = 0.0  # one step of the sensor's converter
    sensor_hum_rel: float = 0.0
    sync_hum_rel: float = 0.0
    mains_hz: float = 50.0
    sensor_harmonics_rel: tuple = ()  # second, third ... of the sensor's own, aliased as they come

    # More than a setting: makes the fault of one calibration (faults/fault.py).
    fault: collections.abc.Callable = Fault

    # Series time stamping.
    shots: int = 12
    series_samples: int = 500
    trigger_noise_rad: float = 0.02
    start: str = "with the trigger"  # or "free-running"
    start_jitter_s: float = 0.0
    corrects_trigger_phase: bool = True
    dso_rate_rel: float = 1e-6  # half width of the oscilloscope's rate error
    trace_noise_v: float = 0.02
    trace_periods: float = 2.0
    trace_step_v: float = 16.0 / 256  # 8 bits over +-8 V
