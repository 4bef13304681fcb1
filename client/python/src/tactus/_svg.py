"""Answers and evaluations as HTML for notebooks: inline SVG, without scripts, styles from
elsewhere or any request. All texts are escaped."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING, Any, Iterable, List, Mapping, Sequence, Tuple

import numpy

from tactus._answers import Answer, Contact, Event

if TYPE_CHECKING:
    from tactus._jobs import Evaluation
    from tactus._stream import Stream

_CELL = 12
_MOST_SIDE = 360
_BAR = 120
_TIMELINE = 320
_DOT = 5
_COLOURS = {"touched": "#1f77b4", "released": "#7f7f7f", "decided": "#2ca02c",
            "changed": "#ff7f0e", "unknown": "#d62728", "merged": "#9467bd",
            "split": "#8c564b", "moved over skin": "#17becf"}


def _tag(name: str, text: str = "", **attributes: object) -> str:
    words = "".join(f' {key.replace("_", "-")}="{escape(str(value), quote=True)}"'
                    for key, value in attributes.items())
    return f"<{name}{words}>{text}</{name}>"


def _svg(width: float, height: float, parts: Iterable[str], label: str) -> str:
    return _tag("svg", "".join(parts), width=f"{width:g}", height=f"{height:g}",
                viewBox=f"0 0 {width:g} {height:g}", role="img", aria_label=label,
                xmlns="http://www.w3.org/2000/svg")


def _shade(fraction: float) -> str:
    """White to dark blue."""
    fraction = min(max(fraction, 0.0), 1.0)
    return "#" + "".join(f"{round(255 + (dark - 255) * fraction):02x}" for dark in (8, 48, 107))


def loads_of(answer: Answer) -> Any:
    """[rows, columns] the loads of the answer's frame in the skin's unit; None
    if the frame is not known."""
    frame = answer.frame
    if frame is None:
        return None
    skin = answer.skin
    loads = frame.astype(float) * skin.scale
    if skin.axes == 1:
        loads = loads[..., None]
    loads = (numpy.maximum(loads[..., skin.normal_axis], 0) if skin.normal_axis is not None
             else numpy.sqrt((loads ** 2).sum(axis=2)))
    loads.reshape(-1)[list(skin.auxiliary_taxels)] = 0
    return loads


def skin_svg(answer: Answer) -> str:
    """The skin: a cell for each touched taxel, darker with its load, and a cross
    at each contact's centroid."""
    skin = answer.skin
    rows, columns = skin.rows, skin.columns
    cell = max(2.0, min(_CELL, _MOST_SIDE / max(rows, columns)))
    parts = [_tag("rect", width=f"{columns * cell:g}", height=f"{rows * cell:g}", fill="#ffffff",
                  stroke="#888888")]
    loads = loads_of(answer)
    if loads is not None and loads.size:
        most = float(loads.max())
        for row, column in zip(*numpy.nonzero(loads > 0)):
            parts.append(_tag(
                "rect", x=f"{column * cell:g}", y=f"{row * cell:g}", width=f"{cell:g}",
                height=f"{cell:g}", fill=_shade(float(loads[row, column]) / most)))
    for contact in answer.contacts:
        if contact.patch is None:
            continue
        x = (contact.patch.centroid_column + 0.5) * cell
        y = (contact.patch.centroid_row + 0.5) * cell
        parts.append(_tag("path", d=f"M{x - 5:g} {y:g}h10M{x:g} {y - 5:g}v10", stroke="#d62728",
                          stroke_width="2", fill="none"))
        parts.append(_tag("text", str(contact.id), x=f"{x + 6:g}", y=f"{y - 3:g}",
                          font_size="11", fill="#d62728"))
    return _svg(columns * cell, rows * cell, parts, f"skin {skin.name}, frame {answer.sequence}")


def bars_svg(named: Mapping[str, float], marked: str = "") -> str:
    """A bar for each probability; the decided value is green."""
    parts: List[str] = []
    width = 8 * max((len(name) for name in named), default=0) + 10
    for i, (name, probability) in enumerate(named.items()):
        y = 16 * i
        parts.append(_tag("text", escape(name), x="0", y=f"{y + 12}", font_size="12"))
        parts.append(_tag("rect", x=f"{width}", y=f"{y + 3}", width=f"{_BAR}", height="10",
                          fill="#eeeeee"))
        if math.isfinite(probability):
            parts.append(_tag("rect", x=f"{width}", y=f"{y + 3}",
                              width=f"{_BAR * probability:.1f}", height="10",
                              fill="#2ca02c" if name == marked else "#1f77b4"))
        parts.append(_tag("text", f"{probability:.3f}", x=f"{width + _BAR + 6}", y=f"{y + 12}",
                          font_size="12"))
    return _svg(width + _BAR + 60, 16 * len(named) + 2, parts, "probabilities")


def timeline_svg(marks: Sequence[Tuple[float, str, str]], begin: float, end: float) -> str:
    """Marks (seconds, kind, text) on a line of time."""
    span = max(end - begin, 1e-9)
    parts = [_tag("line", x1="0", y1="20", x2=f"{_TIMELINE}", y2="20", stroke="#888888")]
    for seconds, kind, text in marks:
        x = _DOT + (_TIMELINE - 2 * _DOT) * (seconds - begin) / span
        parts.append(_tag("circle", _tag("title", escape(text)), cx=f"{x:.1f}", cy="20", r=f"{_DOT}",
                          fill=_COLOURS.get(kind, "#000000")))
    for x, seconds, anchor in ((0, begin, "start"), (_TIMELINE, end, "end")):
        parts.append(_tag("text", f"{seconds:.2f} s", x=f"{x}", y="38", font_size="11",
                          text_anchor=anchor))
    return _svg(_TIMELINE, 42, parts, "timeline")


def contact_html(contact: Contact) -> str:
    """Probabilities of a contact, and when its questions were decided."""
    text = (f"contact {contact.id}, {contact.state}, {contact.since_onset_ns / 1e9:.2f} s "
            f"since onset, unknown {contact.unknown:.3f}")
    blocks = [_tag("div", escape(text)), bars_svg(contact.classes)]
    marks = [(0.0, "touched", "touched")]
    for answer in contact.answers.values():
        decided = answer.decided
        blocks.append(_tag("div", escape(answer.question)))
        blocks.append(bars_svg(answer.values, decided.value if decided else ""))
        if decided is not None:
            seconds = decided.since_onset_ns / 1e9
            marks.append((seconds, "decided",
                          f"{seconds:.2f} s: decided {answer.question}: {decided.value}"))
            if decided.changes:
                seconds = decided.changed_since_onset_ns / 1e9
                marks.append((seconds, "changed", f"{seconds:.2f} s: changed {answer.question}"))
    end = contact.since_onset_ns / 1e9
    blocks.append(timeline_svg(marks, 0.0, max(end, max(mark[0] for mark in marks))))
    return _tag("div", "".join(_tag("div", block) for block in blocks))


def answer_html(answer: Answer) -> str:
    """The skin, its contacts, and what happened at the frame."""
    kind = "final answer" if answer.is_final else "answer"
    head = (f"{kind} to frame {answer.sequence}, {answer.capture_time_ns / 1e9:.3f} s, "
            f"{len(answer.contacts)} contacts")
    events = "".join(_tag("div", escape(str(event))) for event in answer.events)
    contacts = "".join(_tag("td", contact_html(contact), style="vertical-align:top")
                       for contact in answer.contacts)
    table = _tag("table", _tag("tr", _tag("td", skin_svg(answer), style="vertical-align:top")
                               + contacts))
    return _tag("div", _tag("div", escape(head)) + table + events)


def stream_html(stream: "Stream") -> str:
    """What answers the stream, and its last events on a line of time."""
    info = stream.info
    counts = stream.statistics
    state = "ended" if stream.ended else "resuming" if stream.resuming else "connected"
    head = (f"stream of {stream.skin.name} to {info.model_version}: {state}, "
            f"{counts.frames} frames, resumed {counts.resumed} times")
    classes = "classes: " + ", ".join(info.classes)
    events: List[Event] = list(stream._core.events)
    parts = [_tag("div", escape(head)), _tag("div", escape(classes))]
    if events:
        marks = [(event.capture_time_ns / 1e9, event.kind, str(event)) for event in events]
        parts.append(timeline_svg(marks, marks[0][0], marks[-1][0]))
    parts.extend(_tag("div", escape(f"{notice.kind}: {notice.text}"))
                 for notice in stream.notices)
    return _tag("div", "".join(parts))


def _table(caption: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    cells = [_tag("tr", "".join(_tag("th", escape(text)) for text in head))]
    cells.extend(_tag("tr", "".join(_tag("td", escape(str(cell))) for cell in row))
                 for row in rows)
    return _tag("table", _tag("caption", escape(caption)) + "".join(cells))


def evaluation_html(evaluation: "Evaluation") -> str:
    """The accuracy, that of each question, the confusions, and how often answers
    were right by the probability that they had."""
    parts = [_tag("div", escape(f"accuracy {evaluation.accuracy}, log-loss "
                                f"{evaluation.log_loss:.4f}, calibration error "
                                f"{evaluation.calibration_error:.4f}"))]
    if evaluation.trained_on_data:
        parts.append(_tag("div", "The model was trained on some of these contacts."))
    if evaluation.questions:
        parts.append(_table("Questions", ("question", "accuracy"), (
            (name, report.accuracy) for name, report in evaluation.questions.items())))
    parts.append(_table("True class by predicted class", ("", *evaluation.classes), (
        (name, *counts) for name, counts in zip(evaluation.classes, evaluation.confusion))))
    if evaluation.reliability:
        parts.append(_table("Reliability", ("probability", "mean", "accuracy"), (
            (f"{b.low:.3f} to {b.high:.3f}", f"{b.confidence:.3f}", b.accuracy)
            for b in evaluation.reliability)))
    return _tag("div", "".join(parts))
