"""A laboratory that nobody has: what dyncal-web would serve of three benches and their runs, from
formulas, the same every time.

The transfer function is that of an accelerometer with a resonance and a delay; everything is a
plain dictionary in the shape of services/programs/web/PROTOCOL.md, which a test changes as it
likes.
"""

import cmath
import math
import random

METRE_PER_SECOND_SQUARED = "\\metre\\second\\tothe{-2}"
FREQUENCIES = ["10", "12.5", "16", "20", "25", "31.5", "40", "50", "63", "80", "100", "125", "160",
               "200", "250", "315", "400"]
REPETITIONS = 3
CHANNEL = "dau/x_acceleration"
BEGIN_UTC_MS = 1795388400000


def response(frequency_hz):
    resonance = 1 / (1 - (frequency_hz / 2100) ** 2 + 0.02j * frequency_hz / 2100)
    return 0.9973 * resonance * cmath.exp(-2j * math.pi * frequency_hz * 1.7e-3)


def level(frequency_hz):
    return 2.5 if frequency_hz < 16 else 10.0


FLAG = {"name": "samples_lost", "sentences": ["dau: samples lost"],
        "meaning": "samples of this source are missing within the step and the fit uses the "
                   "others; check its network, its buffers and the load of its computer"}


def rounded(value, u):
    """A value and its u as the daemon rounds them, by arithmetic of its own."""
    if value is None:
        return {"value": None, "u": None}
    places = max(0, 1 - math.floor(math.log10(u)))
    return {"value": f"{value:.{places}f}", "u": f"{u:.{places}f}"}


def rounded_texts(magnitude, u_magnitude, phase, u_phase):
    degrees = None if phase is None else math.degrees(phase)
    return {"magnitude": rounded(magnitude, u_magnitude), "phase_rad": rounded(phase, u_phase),
            "phase_deg": rounded(degrees, u_phase and math.degrees(u_phase))}


def point(step, seed=0):
    """Result of a step, counted from 1."""
    text = FREQUENCIES[(step - 1) % len(FREQUENCIES)]
    repetition = (step - 1) // len(FREQUENCIES) + 1
    frequency = float(text)
    drawn = random.Random(1000 * seed + step)
    u_rel, u_phase = 4e-4 * (1 + 40 / frequency), 6e-4 + 2e-6 * frequency
    true = response(frequency)
    magnitude = abs(true) * (1 + drawn.gauss(0, 0.6 * u_rel))
    phase = cmath.phase(true) + drawn.gauss(0, 0.6 * u_phase)
    return {
        "channel": CHANNEL, "step": step, "repetition": repetition, "attempt": 1,
        "frequency_text_hz": text, "frequency_hz": frequency, "level_m_s2": level(frequency),
        "measured_level_m_s2": 0.9876 * level(frequency), "valid": True,
        "problem": "", "magnitude": magnitude, "u_magnitude": magnitude * u_rel,
        "phase_rad": math.remainder(phase, 2 * math.pi), "u_phase_rad": u_phase,
        "U_magnitude": 2 * magnitude * u_rel, "k_magnitude": 2.0, "U_phase_rad": 2 * u_phase,
        "k_phase": 2.0, "unit": "\\one", "lost": 12 if step == 9 else 0,
        "flags": [FLAG["sentences"][0]] if step == 9 else [],
        "flag_names": [FLAG["name"]] if step == 9 else [], "provisional": False,
        "text": rounded_texts(magnitude, magnitude * u_rel, math.remainder(phase, 2 * math.pi),
                              u_phase),
        "sample_rate_hz": 1000.0, "u_sample_rate_hz": 1e-4,
    }


def invalid_point(step):
    return {**point(step), "valid": False, "problem": "no samples of dau/x_acceleration",
            "magnitude": None, "u_magnitude": None, "phase_rad": None, "u_phase_rad": None,
            "text": rounded_texts(None, None, None, None)}


def transfer(points):
    """Means over the repetitions of each frequency."""
    means = []
    before = 0.0
    for text in FREQUENCIES:
        group = [p for p in points if p["frequency_text_hz"] == text and p["valid"]]
        if not group:
            continue
        n = len(group)
        magnitude = sum(p["magnitude"] for p in group) / n
        phase = group[0]["phase_rad"] + sum(
            math.remainder(p["phase_rad"] - group[0]["phase_rad"], 2 * math.pi) for p in group) / n
        before = phase + 2 * math.pi * round((before - phase) / (2 * math.pi))
        u = max(p["u_magnitude"] for p in group) / math.sqrt(n)
        u_phase = max(p["u_phase_rad"] for p in group) / math.sqrt(n)
        wrapped = math.remainder(phase, 2 * math.pi)
        means.append({
            "channel": CHANNEL, "unit": "\\one", "frequency_text_hz": text,
            "frequency_hz": float(text),
            "level_m_s2": group[0]["level_m_s2"], "magnitude": magnitude, "u_magnitude": u,
            "measured_level_m_s2": group[0]["measured_level_m_s2"],
            "U_magnitude": 2.1 * u, "k_magnitude": 2.1,
            "phase_rad": wrapped, "u_phase_rad": u_phase,
            "U_phase_rad": 2.05 * u_phase, "k_phase": 2.05, "unwrapped_phase_rad": before,
            "scatter_magnitude": u, "scatter_phase_rad": u_phase, "repetitions": n,
            "flags": [flag for p in group for flag in p["flags"]],
            "flag_names": [name for p in group for name in p["flag_names"]],
            "text": rounded_texts(magnitude, 2.1 * u, wrapped, 2.05 * u_phase),
        })
    return means


CLOSURES = [
    {"kind": "clock_rate", "title": "rate of the sensor's clock", "subject": "dau", "verdict":
     "closes", "value": 3.12e-6, "u": 2.1e-7, "limit": 2e-4, "unit": "1",
     "sentence": "the clock of dau is 3.12 ppm fast"},
    {"kind": "first_repeated", "title": "first point repeated at the end", "subject": "",
     "verdict": "not_possible", "value": 0.0, "u": None, "limit": None, "unit": "",
     "sentence": "the plan does not end with its first point (repeat_first)"},
    {"kind": "phase_at_zero", "title": "phase towards 0 Hz", "subject": "", "verdict": "open",
     "value": 0.0512, "u": 0.0041, "limit": 0.0184, "unit": "rad",
     "sentence": "towards 0 Hz the phase tends to 2.934 degrees (u 0.23), where 0 or 180 is "
                 "expected"},
]


def channel():
    return {"channel": CHANNEL, "unit": "\\one", "responds": True, "lost": 12, "flags": [],
            "flag_names": [], "advice": "Repeat more often.", "closures": CLOSURES,
            "text": {"group_delay_ms": {"value": "1.7003", "u": "0.0012", "U": "0.0024",
                                        "k": "2.00"}}}


def clock_report():
    """As the page gets it; with what its figures are made of."""
    histogram = [{"interval_ns": 999000 + 16.7 * i,
                  "interval_count": int(30000 * math.exp(-((i - 60) / 14) ** 2)) + 1}
                 for i in range(120)]
    course = [{"time_s": t, "min_interval_ns": 999100 + 50 * math.sin(t / 90),
               "max_interval_ns": 1000900 + 50 * math.sin(t / 90),
               "mean_interval_ns": 1000000 + 40 * math.sin(t / 90)} for t in range(0, 600, 2)]
    return {"source": "dau", "count": 612345, "mean_interval_s": 1.00000312e-3,
            "u_mean_interval_s": 2.1e-10, "sd_s": 2.3e-7, "min_s": 9.99e-4, "max_s": 1.001e-3,
            "mean_rate_hz": 999.99688, "nominal_rate_hz": 1000.0, "tick_s": 1.67e-8,
            "event_count": 3, "lost": 12, "flags": [], "flag_names": [], "histogram": histogram,
            "over_time": course,
            "text": {"mean_interval_us": {"value": "1000.00312", "u": "0.00021",
                                          "U": "0.00042", "k": "2.00"}}}


def sources(last_message_ms):
    def channel(title, quantity, unit, limit, peak=None):
        return {"name": title, "quantity": quantity, "unit": unit, "minimum": -limit,
                "maximum": limit, "resolution": 1e-4, "level_peak": peak, "level_rms": None,
                "over_range": 0}

    unit = METRE_PER_SECOND_SQUARED
    common = {"lost_in_device": "0", "lost_in_transit": "0", "duplicates": "0",
              "rejected": "0", "stamps_not_trusted": "0", "dropped_in_service": "0",
              "causes": [], "buffer_fill": 0.02, "matched_readers": 2, "message": "",
              "last_message_utc_ms": last_message_ms, "state": "running"}
    return [
        {"source": "dau", "kind": "dau", "device": "SmartUp unit", "serial": "0xbccb0100",
         "driver": "smartup", "host": "lab-1", "rate_hz": 999.97, "nominal_rate_hz": 1000.0,
         "received": "1234567", "clock_uncertainty_s": 1e-6, "time_base": "utc", **common,
         "lost_in_transit": "12", "causes": [{"name": "sequence gap", "value": "1"}],
         "channels": [channel("x_acceleration", "acceleration", unit, 39.2, 9.3),
                      channel("y_acceleration", "acceleration", unit, 39.2, 0.1),
                      channel("z_acceleration", "acceleration", unit, 39.2, 38.9),
                      channel("sync", "voltage", "\\volt", 10, 1.1)]},
        {"source": "acs", "kind": "acs", "device": "laser vibrometer", "serial": "17",
         "driver": "socket", "host": "lab-2", "rate_hz": 10000.2, "nominal_rate_hz": 10000.0,
         "received": "9007199254740993", "clock_uncertainty_s": 5e-7, "time_base": "utc",
         **common, "channels": [channel("reference", "acceleration", unit, 100, 10),
                                channel("sync", "voltage", "\\volt", 5, 0.5)]}]


def signal(seconds=2.0, columns=500, now_ms=BEGIN_UTC_MS, number=1, amplitude=9.2):
    drawn = random.Random(5)
    rows = []
    for i in range(columns):
        t = seconds * i / columns
        y = amplitude * math.sin(2 * math.pi * 16 * t)
        spread = 0.05 + 0.05 * drawn.random()
        rows.append([t, y - spread, y + spread])
    return {"number": number, "source": "dau", "channel": "x_acceleration",
            "unit": METRE_PER_SECOND_SQUARED, "minimum": -39.2, "maximum": 39.2, "rate_hz": 1000.0,
            "begin_utc_ms": now_ms - 1000 * seconds, "columns": rows,
            "level_rms": amplitude / math.sqrt(2), "level_peak": amplitude + 0.1,
            "over_range": 0, "gaps": [[0.71, 0.74]], "now_utc_ms": now_ms}


def spectrum():
    drawn = random.Random(6)
    lines = []
    for i in range(1, 1000):
        f = i / 2
        tone = sum(a * math.exp(-((f - f0) / 0.5) ** 2)
                   for f0, a in ((16, 9.2), (32, 0.03), (48, 0.011), (50, 0.004)))
        lines.append([f, tone + 4e-4 * (0.3 + drawn.random())])
    return {"unit": METRE_PER_SECOND_SQUARED, "lines": lines, "fundamental_hz": 16.0003,
            "amplitude": 9.2014, "thd": 0.0035, "noise_floor": 4.1e-4, "window": "Hann",
            "resolution_hz": 0.5}


def fit():
    def one(channel, amplitude, unit):
        ts = [i / 1000 for i in range(250)]
        wave = [amplitude * math.sin(2 * math.pi * 16 * t) for t in ts]
        left = [0.004 * amplitude * math.sin(2 * math.pi * 48 * t + 1) for t in ts]
        return {"channel": channel, "unit": unit,
                "fit": {"frequency_hz": 16.00031, "u_frequency_hz": 2.2e-5, "sine": amplitude,
                        "cosine": 0.0, "offset": 0.0, "amplitude": amplitude,
                        "u_amplitude": 1e-4 * amplitude, "residual_rms": 0.003 * amplitude,
                        "sample_count": 10000,
                        "text": {"amplitude": rounded(amplitude, 1e-4 * amplitude)}},
                "columns": [[t, y + r, y + r] for t, y, r in zip(ts, wave, left)],
                "model": [[t, y] for t, y in zip(ts, wave)],
                "residual_columns": [[t, r, r] for t, r in zip(ts, left)]}

    return {"number": 1, "step": 3, "attempt": 1, "frequency_text_hz": "16", "state": "steady",
            "reference": one("acs/reference", 10.02, METRE_PER_SECOND_SQUARED),
            "sync": one("acs/sync", 0.5, "\\volt"),
            "dau_phase": {"channel": "dau/sync", "unit": "rad",
                          "columns": [[t / 10, 0.3 + 2e-4 * math.sin(t)] for t in range(100)]}}


def budget(channel, step=0, repetition=0, frequency="", level=None):
    """Of a step, or of a mean, by its frequency."""
    rows = [("reference", "acs/reference", 3.1e-4, 4.2e-4), ("fit_noise", channel, 1.2e-4, 1.9e-4),
            ("adc_phase", "dau/sync", None, 3.3e-4), ("stamp_jitter", "dau", 2e-6, 6e-5),
            ("mains_hum", channel, 4e-5, 4e-5)]
    if frequency:
        rows.append(("scatter of the repetitions", "", 9e-4, 8e-4))
    return {"channel": channel, **({"frequency_text_hz": frequency, "level_m_s2": float(level)}
                                   if frequency else {"step": int(step),
                                                      "repetition": int(repetition)}),
            "contributions": [
                {"kind": kind, "subject": subject, "name": kind.replace("_", " "),
                 "distribution": "normal", "repeats": "anew", "degrees_of_freedom": None,
                 "u_magnitude_rel": a, "u_phase_rad": b} for kind, subject, a, b in rows]}


def history(sensor):
    runs = []
    for i, name in enumerate(("run-38", "run-39", "run-40")):
        points = [point(step, seed=i + 1) for step in range(1, 3 * len(FREQUENCIES) + 1)]
        runs.append({"run": name, "bench": "acc-1", "utc_ms": BEGIN_UTC_MS + 86400000 * (i - 3),
                     "state": "done", "channel": CHANNEL, "points": transfer(points)})
    errors = []
    for a, b in ((0, 1), (1, 2)):
        for p, q in zip(runs[a]["points"], runs[b]["points"]):
            errors.append({
                "of": runs[b]["run"], "against": runs[a]["run"],
                "frequency_text_hz": p["frequency_text_hz"],
                "en_magnitude": (q["magnitude"] - p["magnitude"]) / math.hypot(
                    p["U_magnitude"], q["U_magnitude"]),
                "en_phase": (q["phase_rad"] - p["phase_rad"]) / math.hypot(
                    p["U_phase_rad"], q["U_phase_rad"])})
    due = [{"what": "sensor", "name": "Sensor Works MPU-9250", "serial": "SN-7", "owner": None,
            "last": None, "certificate": None, "due": None, "overdue": True},
           {"what": "reference", "name": "Reference 8305", "serial": "1234567", "owner": None,
            "last": "2025-01-07", "certificate": "R-2025-3", "due": "2025-06-30", "overdue": True},
           {"what": "sensor", "name": "Sensor Works MPU-9250", "serial": "0xbccb0100",
            "owner": "Customer Example", "last": "2026-01-07", "certificate": "2026-0042",
            "due": "2999-01-07", "overdue": False}]
    return {"sensors": ["0xbccb0100", "ADXL355 17"], "sensor": sensor, "runs": runs, "en": errors,
            "due": due}
