"""What dyncal-web would answer at /figures of the laboratory that is played: pictures described as
services/views/report/picture_json.hpp does, made from its own points and as plainly as possible.

Their members are held against those of the real program in real_laboratory_test.py.
"""

import math

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]
MARKERS = ["circle", "square", "triangle", "cross"]
BARS = {"U": ("U_magnitude", "U_phase_rad"), "u": ("u_magnitude", "u_phase_rad"), "none": None}


def panel(x_label, y_label, series=(), **members):
    return {"x_label": x_label, "y_label": y_label, "x_scale": "linear", "y_scale": "linear",
            "y_range": None, "colour": "#0072B2", "band_label": "", "dots_label": "", "band": [],
            "bars": [], "dots": [], "series": list(series), **members}


def one_series(label, points, **members):
    return {"label": label, "colour": "#333333", "marker": "none", "radius": 4, "joined": False,
            "dashes": "", "line_width": 1.4, "points": points, **members}


def picture(name, title, panels, height, subtitle=""):
    return {"name": name, "title": title, "subtitle": subtitle, "panel_height": height,
            "panels": panels}


def half(value, quantity, bars):
    keys = BARS[bars]
    return (value[keys[quantity]] or 0) if keys else 0


def of_channel(title, subtitle, points, means, is_over, bars):
    """means: as a transfer function has them; while the run lasts without uncertainty."""
    of_mean, of_point = (bars, "none") if is_over else ("none", bars)
    by_frequency = {m["frequency_hz"]: m for m in means}
    points = [p for p in points if p["valid"] and p["frequency_hz"] in by_frequency]
    keys = ("magnitude", "unwrapped_phase_rad"), ("magnitude", "phase_rad")

    def mean_series(quantity):
        return one_series(f"mean ± {bars}" if of_mean != "none" else
                          "mean" if is_over else "mean so far",
                          [[m["frequency_hz"], m[keys[0][quantity]], half(m, quantity, of_mean), 0]
                           for m in means], colour="#222222", joined=True, line_width=1.1)

    def repetitions(value_of, label):
        numbers = sorted({p["repetition"] for p in points})
        return [one_series(f"#{n}{label}", [value_of(p) for p in points if p["repetition"] == n],
                           colour=COLOURS[i % 6], marker=MARKERS[i % 4], radius=6 - 1.2 * (i % 3))
                for i, n in enumerate(numbers)]

    def value(quantity):
        def of(p):
            mean = by_frequency[p["frequency_hz"]][keys[0][quantity]]
            y = p[keys[1][quantity]]
            if quantity == 1:
                y += 2 * math.pi * round((mean - y) / (2 * math.pi))
            return [p["frequency_hz"], y, half(p, quantity, of_point), p["step"]]
        return of

    def deviation(quantity):
        def of(p):
            mean = by_frequency[p["frequency_hz"]][keys[0][quantity]]
            x, y, bar, step = value(quantity)(p)
            factor = 100 / mean if quantity == 0 else 180 / math.pi
            return [x, factor * (y - mean), factor * bar, step]
        return of

    def rings(quantity):
        flagged = [[m["frequency_hz"], m[keys[0][quantity]], 0, 0] for m in means if m["flags"]]
        return [one_series("flagged, see below", flagged, colour="#CC0000", marker="circle",
                           radius=9)] if flagged else []

    frequency = "frequency in Hz"
    label = f" ± {bars}" if of_point != "none" else ""
    unit = points[0]["unit"].replace("\\one", "1") if points else ""
    log = {"x_scale": "logarithmic"}

    def band(quantity):
        if of_mean == "none":
            return {}
        factors = [100 / m["magnitude"] if quantity == 0 else 180 / math.pi for m in means]
        return {"band_label": f"± {bars} of the mean", "colour": "#cccccc",
                "band": [[m["frequency_hz"], -f * half(m, quantity, bars),
                          f * half(m, quantity, bars)] for m, f in zip(means, factors)]}

    return [
        picture("transfer-function", title, [
            panel(frequency, f"magnitude in {unit}",
                  [mean_series(0), *repetitions(value(0), label), *rings(0)], **log),
            panel(frequency, "phase (lead) in rad",
                  [mean_series(1), *repetitions(value(1), label), *rings(1)], **log)],
            270, subtitle),
        picture("deviation", f"{title}: repetitions less their mean", [
            panel(frequency, "magnitude in %", repetitions(deviation(0), label), **log, **band(0)),
            panel(frequency, "phase in degrees", repetitions(deviation(1), label), **log,
                  **band(1)),
            panel(frequency, "residual of the fit in %", repetitions(
                lambda p: [p["frequency_hz"], 0.3 + 0.01 * p["step"], 0, p["step"]], ""),
                y_scale="logarithmic", **log)], 190, subtitle)]


def of_clock(report, subtitle):
    source = report["source"]
    bins = [[1e-3 * b["interval_ns"], 1e-3 * (b["interval_ns"] + 16.7), b["interval_count"]]
            for b in report["histogram"]]
    course = report["over_time"]
    interval = "sample interval in µs"
    return [
        picture("interval-histogram", f"Sample intervals of {source}", [
            panel(interval, "count per bin", bars=bins, y_scale="logarithmic",
                  y_range=[0.6, 1.7 * max(b[2] for b in bins)])], 330,
            f"{report['count']} intervals"),
        picture("interval-over-time", f"Sample interval of {source} over time", [
            panel("time in s", interval, [one_series(
                "mean", [[c["time_s"], 1e-3 * c["mean_interval_ns"], 0, 0] for c in course],
                colour="#222222", joined=True, line_width=1)],
                band=[[c["time_s"], 1e-3 * c["min_interval_ns"], 1e-3 * c["max_interval_ns"]]
                      for c in course], band_label="smallest to largest")], 230, subtitle),
        picture("interval-over-temperature", f"Sample interval of {source} over its temperature", [
            panel("temperature measured by the sensor in °C", interval,
                  dots=[[23 + 0.01 * i, 1e-3 * c["mean_interval_ns"] + 0.02 * math.sin(i)]
                        for i, c in enumerate(course)], dots_label="single intervals")],
            360, subtitle)]


def of_interferometer(displacement, subtitle):
    centre, radius, ratio, lag = (0.021, -0.018), 0.64, 1.046, 0.087
    turn = [2 * math.pi * i / 180 for i in range(181)]
    raw = [[centre[0] + radius * math.cos(x), centre[1] + radius / ratio * math.sin(x - lag), 0, 0]
           for x in turn]
    circle = [[radius * math.cos(x), radius * math.sin(x), 0, 0] for x in turn]
    orders = [one_series(f"order {k}: {nm} nm", [[math.degrees(x), nm * math.sin(k * x), 0, 0]
                                                 for x in turn],
                         colour=COLOURS[k % 6], joined=True)
              for k, nm in enumerate((0.004, 0.011, 0.002, 0.27), 1)]
    return [picture("ellipse", f"Interferometer of {displacement}", [
        panel("u1, corrected X, in the unit of the signals", "u2, Y", [
            one_series("as recorded", raw, colour=COLOURS[1], joined=True),
            one_series("corrected", circle, colour=COLOURS[0], joined=True)]),
        panel("phase in degrees", "error of the displacement in nm", orders,
              band=[[0, -0.01, 0.01], [360, -0.01, 0.01]], band_label="± u of the ellipse")],
        374, subtitle)]
