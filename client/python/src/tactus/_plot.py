"""Answers as figures of matplotlib."""

from __future__ import annotations

from typing import Any

from tactus._answers import Answer
from tactus._svg import loads_of


def plot_answer(answer: Answer, axes: Any = None) -> Any:
    """Draws the skin on one pair of axes and the probabilities of the main
    contact on another; ``axes`` may be two of the caller's."""
    import matplotlib.pyplot as plt

    if axes is None:
        _, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    skin_axes, bar_axes = axes
    loads = loads_of(answer)
    if loads is not None:
        image = skin_axes.imshow(loads, cmap="Blues", vmin=0, origin="upper")
        skin_axes.figure.colorbar(image, ax=skin_axes, label=answer.skin.unit)
    for contact in answer.contacts:
        if contact.patch is not None:
            place = (contact.patch.centroid_column, contact.patch.centroid_row)
            skin_axes.plot(*place, "r+", markersize=10)
            skin_axes.annotate(str(contact.id), place, color="red")
    skin_axes.set_title(f"{answer.skin.name}, frame {answer.sequence}")
    skin_axes.set_xlabel("column")
    skin_axes.set_ylabel("row")
    main = answer.main
    if main is not None:
        named = dict(main.classes)
        for question in main.answers.values():
            for value, probability in question.values.items():
                named[f"{question.question}: {value}"] = probability
        bar_axes.barh(list(named), list(named.values()))
        bar_axes.invert_yaxis()
        bar_axes.set_xlim(0, 1)
        bar_axes.set_xlabel("probability")
        bar_axes.set_title(f"contact {main.id}, {main.since_onset_ns / 1e9:.2f} s")
    return axes
