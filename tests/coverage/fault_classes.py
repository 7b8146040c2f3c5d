"""The classes of calibrations that are drawn: clean ones, and one class for each fault.

A class is a bench with some of its settings changed. What is expected of each is in
expected_outcomes.py. Faults that are more than a setting have a module in faults/ for each kind,
with its classes and what is expected of them.
"""

import faults
from class_presets import (
    AT_50_HZ,
    BESIDE_50_HZ,
    BESIDE_60_HZ,
    HARDLY_ANY_NOISE,
    LITTLE_NOISE,
    LOW_FREQUENCIES,
    RUN_SCATTER_REL,
    SERIES,
    SHORT_ANALOGUE_STEPS,
    bench,
)

faults.collect()

CLASSES = {
    # Clean, or as clean as benches are.
    "clean": bench(),
    "clean, analogue": bench(method="analogue"),
    "clean, absolute time": bench(method="absolute-time"),
    "clean, series": bench(SERIES),
    "clean, calibrated reference": bench(calibrated_reference=True),
    "clean, series, calibrated reference": bench(SERIES, calibrated_reference=True),
    "clean, 0.4 Hz": bench(LOW_FREQUENCIES),
    "clean, 0.4 Hz, rates that fold the mains": bench(
        LOW_FREQUENCIES, acs_rate_hz=500.0, sensor_rate_hz=250.0
    ),
    "clean, series, harmonics fold": bench(
        SERIES, frequencies=("20", "40", "80", "125", "160", "200")
    ),
    "clean, 0.4 Hz, pauses of 0.5 s": bench(LOW_FREQUENCIES, pause_s=0.5),
    "clean, resolution of 1 noise": bench(resolution_rel=0.01),
    "clean, exciter with 3 % harmonics": bench(harmonics_rel=(0.03, 0.02)),
    "clean, hum far from the steps": bench(sensor_hum_rel=0.001, sync_hum_rel=0.001),
    "clean, sync with 10 % noise": bench(sync_noise_rel=0.1),
    "clean, sensor with as much noise as signal": bench(sensor_noise_rel=1.0),
    "clean, regular stamps": bench(
        regular_stamps=True, sensor_rate_hz=1000.0, sensor_rate_scatter_rel=0.0
    ),
    "clean, hardly any noise": bench(HARDLY_ANY_NOISE, method="analogue"),
    "clean, series with hardly any noise": bench(SERIES, HARDLY_ANY_NOISE),
    # Repetitions.
    **{
        f"mean of {n}": bench(SHORT_ANALOGUE_STEPS, repetitions=n) for n in (1, 2, 3, 5, 10)
    },
    **{
        f"mean of {n}, runs scatter": bench(
            SHORT_ANALOGUE_STEPS, repetitions=n, run_scatter_rel=RUN_SCATTER_REL
        )
        for n in (2, 3, 5, 10)
    },
    # Start of a series.
    "free-running series": bench(SERIES, start="free-running"),
    "series with start jitter of 50 us": bench(SERIES, start_jitter_s=50e-6),
    "phase of the trigger not corrected": bench(
        SERIES, corrects_trigger_phase=False, trigger_noise_rad=0.1
    ),
    "clock of the oscilloscope 25 ppm off": bench(
        SERIES,
        LITTLE_NOISE,
        states_dso_rate=False,
        dso_rate_rel=25e-6,
        frequencies=("160", "200", "250", "315", "400"),
    ),
    # Range and level.
    "sensor clipped at 0.95 A": bench(sensor_range_rel=0.95, sensor_offset_rel=0.0),
    "sensor clipped at 0.99 A": bench(
        LITTLE_NOISE, sensor_range_rel=0.99, sensor_offset_rel=0.0
    ),
    "gravity on a 4 g axis": bench(
        gravity=True, level_m_s2=30.0, sensor_range_m_s2=4.0 * 9.80665, sensor_noise_rel=0.002
    ),
    "reference clipped at 0.95 A": bench(reference_range_rel=0.95),
    "50 samples stuck": bench(stuck_samples=50),
    "level 30 % above plan": bench(level_factor=1.3),
    "level 50 times the plan": bench(level_factor=50.0),
    # Losses and order.
    "1 % lost": bench(lost_rel=0.01),
    "1 % lost, no sample numbers": bench(lost_rel=0.01, records_sample_numbers=False),
    "10 % lost, no sample numbers": bench(lost_rel=0.1, records_sample_numbers=False),
    "1 % not measured": bench(not_measured_rel=0.01),
    "1 % of the reference not measured": bench(reference_not_measured_rel=0.01),
    "duplicate and backward stamps": bench(disordered_stamps=4),
    "disordered stamps, no sample numbers": bench(
        disordered_stamps=4, records_sample_numbers=False
    ),
    # The signal itself.
    "drift of 2 % at 0.4 Hz": bench(LOW_FREQUENCIES, LITTLE_NOISE, drift_rel=0.02),
    "drift of 0.5 % at 0.4 Hz": bench(LOW_FREQUENCIES, LITTLE_NOISE, drift_rel=0.005),
    "resolution of A / 3, no noise": bench(sensor_noise_rel=0.0, resolution_rel=1.0 / 3.0),
    "resolution of A / 20, no noise": bench(
        LITTLE_NOISE, sensor_noise_rel=0.0, resolution_rel=1.0 / 20.0
    ),
    "0.1 % hum at 50 Hz": bench(LITTLE_NOISE, frequencies=AT_50_HZ, sensor_hum_rel=0.001),
    "0.1 % hum beside 50 Hz": bench(
        LITTLE_NOISE, frequencies=BESIDE_50_HZ, sensor_hum_rel=0.001
    ),
    "0.1 % hum beside 60 Hz": bench(
        LITTLE_NOISE, frequencies=BESIDE_60_HZ, sensor_hum_rel=0.001, mains_hz=60.0
    ),
    "0.5 % hum on sync beside 50 Hz": bench(frequencies=BESIDE_50_HZ, sync_hum_rel=0.005),
    "aliased harmonic beside a third of the rate": bench(
        LITTLE_NOISE,
        frequencies=("334.20", "334.25", "334.30", "334.40", "334.45", "334.50"),
        sensor_rate_scatter_rel=2e-5,
        sensor_harmonics_rel=(0.002,),
    ),
    "sensor upside down": bench(sensor_sign=-1.0),
    # What the bench file does not say, or says wrongly.
    "ADC not calibrated": bench(
        LITTLE_NOISE,
        states_adc_calibration=False,
        frequencies=("125", "160", "200", "250", "315", "400"),
    ),
    "ADC not calibrated, its delay bounded": bench(
        LITTLE_NOISE,
        states_adc_calibration=False,
        stated_u_adc_delay_s=0.3e-6,
        frequencies=("125", "160", "200", "250", "315", "400"),
    ),
    "uncertainty of the reference not stated": bench(
        LITTLE_NOISE,
        states_reference_uncertainty=False,
        u_reference_magnitude_rel=1e-3,
        u_reference_phase_rad=1e-3,
    ),
    "the reference in the role of sync": bench(sync_acs_channel="ref"),
    "steps above half the sample rate": bench(frequencies=("520", "560", "600", "640")),
    "series, steps above half the sample rate": bench(
        SERIES, frequencies=("520", "560", "600", "640")
    ),
    **faults.CLASSES,
}

# What happens too seldom to be met in few calibrations: these draws of their class, and no others.
CHOSEN_DRAWS = {
    # A frame that held the end of one step and the beginning of the next was taken for the
    # beginning of the next: the DAU's record of it fell in two. Met twice in 600 calibrations.
    "clean, 0.4 Hz, pauses of 0.5 s": (159, 219),
}
# Classes that need more calibrations than others to show what is wrong: so many times the usual.
MORE_DRAWS = {
    "clean, series with hardly any noise": 5,
    "0.5 % hum on sync beside 50 Hz": 5,
    **{f"mean of {n}": 5 for n in (3, 5, 10)},
    **faults.MORE_DRAWS,
}


# Kinds of faults have several strengths each, so that a third of the draws says as much of a kind.
PART_OF_KINDS = 3


def draws_of(fault_class, usual):
    """Numbers of the calibrations that are drawn."""
    if fault_class in CHOSEN_DRAWS:
        return CHOSEN_DRAWS[fault_class]
    if fault_class in faults.CLASSES:
        usual = max(1, usual // PART_OF_KINDS)
    return range(usual * MORE_DRAWS.get(fault_class, 1))
