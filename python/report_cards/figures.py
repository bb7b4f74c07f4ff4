"""Figures of the report cards, as SVG."""

from __future__ import annotations

import html
import math

COLOURS = ("#4e79a7", "#f28e2b", "#e15759", "#76b7b2", "#59a14f", "#b07aa1", "#9c755f", "#d37295", "#17708a", "#bab0ac", "#86561b", "#000000")
Curves = dict[str, dict[str, list[tuple[float, float]]]]


def heat_map(titles: list[str], shares: dict[str, list[float | None]]) -> str:
    """Path errors over path lengths: a row for each engine, a column for each scene."""
    left, top, wide, high = 230, 110, 78, 28
    parts = []
    for at, title in enumerate(titles):
        x = left + (at + 0.5) * wide
        parts.append(f'<text transform="translate({x + 4:.0f} {top - 8}) rotate(-40)">{html.escape(title)}</text>')
    for row, (name, values) in enumerate(shares.items()):
        y = top + row * high
        parts.append(_text(left - 8, y + 19, name, "end"))
        for at, share in enumerate(values):
            fill, label = ("#eeeeee", "no answer") if share is None else (_colour(share), _percent(share))
            parts.append(f'<rect x="{left + at * wide}" y="{y}" width="{wide - 2}" height="{high - 2}" fill="{fill}"/>')
            parts.append(_text(left + (at + 0.5) * wide - 1, y + 18, label, "middle"))
    caption = "largest path error over the path length, at steps of 1 ms; green is within 1 %"
    bottom = top + len(shares) * high
    return _svg(left + len(titles) * wide + 40, bottom + 34, [*parts, _text(left, bottom + 22, caption)])


def work_precision(curves: Curves) -> str:
    """Path error over CPU time, a panel for each scene."""
    wide, high, gap, left, top = 300, 300, 40, 85, 40
    every = [point for of_scene in curves.values() for points in of_scene.values() for point in points]
    (x_low, x_high), (y_low, y_high) = (_decades([point[at] for point in every]) for at in (0, 1))
    parts, names = [], sorted({name for of_scene in curves.values() for name, points in of_scene.items() if points})
    for panel, (scene, of_scene) in enumerate(curves.items()):
        x0 = left + panel * (wide + gap)

        def place(cpu: float, error: float) -> tuple[float, float]:
            across, up = (math.log10(cpu) - x_low) / (x_high - x_low), (math.log10(error) - y_low) / (y_high - y_low)
            return x0 + across * wide, top + (1.0 - up) * high

        parts.append(f'<rect x="{x0}" y="{top}" width="{wide}" height="{high}" fill="none" stroke="#999"/>')
        parts.append(_text(x0 + wide / 2, top - 12, scene, "middle"))
        for decade in range(x_low, x_high + 1):
            x = place(10.0**decade, 10.0**y_low)[0]
            parts += [_line(x, top, x, top + high), _text(x, top + high + 16, _time(decade), "middle")]
        for decade in range(y_low, y_high + 1):
            y = place(10.0**x_low, 10.0**decade)[1]
            parts.append(_line(x0, y, x0 + wide, y))
            if panel == 0:
                parts.append(_text(x0 - 6, y + 4, _percent(10.0**decade), "end"))
        for name, points in sorted(of_scene.items()):
            if not points:
                continue
            colour, places = COLOURS[names.index(name) % len(COLOURS)], [place(*point) for point in points]
            line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.5"/>')
            parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in places]
        parts.append(_text(x0 + wide / 2, top + high + 36, "CPU time of one run", "middle"))
    for at, name in enumerate(names):
        x, y = left + (at % 4) * 245, top + high + 62 + (at // 4) * 20
        parts.append(f'<circle cx="{x}" cy="{y - 4}" r="4" fill="{COLOURS[at % len(COLOURS)]}"/>')
        parts.append(_text(x + 10, y, name))
    return _svg(left + len(curves) * (wide + gap), top + high + 80 + 20 * math.ceil(len(names) / 4), parts)


def _decades(values: list[float]) -> tuple[int, int]:
    return math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))


def _time(decade: int) -> str:
    return f"{10.0 ** (decade + 3):g} ms" if decade < 0 else f"{10.0**decade:g} s"


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %" if share < 0.1 else f"{100.0 * share:.0f} %"


def _colour(share: float) -> str:
    """Green up to 1 %, then yellow at 10 % to red at 100 %."""
    if share <= 0.01:
        return "#a6dba0"
    shade = min(1.0, math.log10(share / 0.01) / 2.0)
    return f"rgb(250,{round(235 - 130 * shade)},{round(160 - 60 * shade)})"


def _line(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="#e4e4e4"/>'


def _text(x: float, y: float, text: str, anchor: str = "start") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{html.escape(text)}</text>'


def _svg(width: float, height: float, parts: list[str]) -> str:
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" font-family="sans-serif" font-size="13">'
    return "\n".join([head, f'<rect width="{width:.0f}" height="{height:.0f}" fill="white"/>', *parts, "</svg>"]) + "\n"
