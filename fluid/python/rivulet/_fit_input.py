"""What a fit is given: checks of its arguments, and FIT.json (docs/fitting.md has its keys). Each check raises BadInput, which names the place and the
remedy."""
from __future__ import annotations

import json
import pathlib
import sys
from typing import Any, Collection, Mapping

import numpy as np

from ._library import BadInput

OF_A_WORLD = ("fluid", "emitters", "sinks", "dry")  # the parts of a scene that act on water; colliders and the like need a function `start`
KEYS = ("scene", "parameters", "measured", "series", "start", "settings", "seconds", "shift", "method", "evaluations", "tolerance", "folder", "jobs",
        "backend", "frame", "seed", "label", "unit")
BACKENDS = ("auto", "cpu", "gl", "cl")
_MOST = sys.float_info.max


def _shown(value: Any) -> str:
    text = json.dumps(value, default=repr)
    return text if len(text) <= 60 else text[:57] + "..."


def number(value: Any, what: str, low: float = -_MOST, high: float = _MOST, wanted: str = "a finite number") -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)) or not low <= value <= high:
        raise BadInput(f"{what} is {_shown(value)}: give {wanted}")
    return float(value)


def whole_number(value: Any, what: str, least: int, why: str = "") -> int:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or not least <= value < 2**31:
        raise BadInput(f"{what} is {_shown(value)}: give a whole number of at least {least}{why}")
    return int(value)


def one_of(value: Any, choices: Collection[str], what: str) -> str:
    if value not in choices:
        raise BadInput(f"{what} is {_shown(value)}: use {', '.join(choices)}")
    return str(value)


def text(value: Any, what: str, wanted: str) -> str:
    if not isinstance(value, str):
        raise BadInput(f"{what} is {_shown(value)}: give {wanted}")
    return value


def mapping(value: Any, what: str, wanted: str, keys: Collection[str] | None = None, needed: Collection[str] = ()) -> Mapping[str, Any]:
    """keys: those that it may have, None: any text."""
    if not isinstance(value, Mapping):
        raise BadInput(f"{what} is {_shown(value)}: give {wanted}")
    for key in value:
        if not isinstance(key, str) or (keys is not None and key not in keys):
            raise BadInput(f"{key} is no key of {what}; the keys are {', '.join(sorted(keys or ['paths of docs/parameters.md']))}")
    for key in needed:
        if key not in value:
            raise BadInput(f"{what} lacks {key}: give {wanted}")
    return value


def check_path(path: str, what: str) -> None:
    """A path of a parameter that a world has."""
    part = path.split(".")[0]
    if part == "budget" or path == "fluid.frameBudget":
        raise BadInput(f"{what}: {path} cannot be set in a fit, because what it changes depends on the speed of the machine: set or fit "
                       "fluid.spacing and fluid.method, which a budget picks")
    if part not in OF_A_WORLD or path == part:
        raise BadInput(f"{what}: {path} is no parameter of the water: give a path that begins with {', '.join(OF_A_WORLD)}, for example "
                       "fluid.viscosity")


def shift_of(shift: Any) -> tuple[float, float]:
    wanted = "the smallest and the largest difference of the clocks in seconds, for example [-0.02, 0.02]"
    if not isinstance(shift, (list, tuple, np.ndarray)) or len(shift) != 2:
        raise BadInput(f"shift is {_shown(shift)}: give {wanted}")
    low, high = (number(value, "shift", wanted=wanted) for value in shift)
    if low > high:
        raise BadInput(f"shift goes from {low:g} to {high:g}: give {wanted}")
    return low, high


def scene_of(scene: Any) -> dict[str, Any]:
    """A scene, or that of a file."""
    place = "scene"
    if isinstance(scene, (str, pathlib.PurePath)):
        place = f"the scene {scene}"
        try:
            scene = json.loads(pathlib.Path(scene).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise BadInput(f"{place} cannot be read: {error}") from error
    return dict(mapping(scene, place, 'an object with "fluid", or the name of a scene file'))


def _rows(path: pathlib.Path, columns: list[int], factors: tuple[float, float]) -> list[list[float]]:
    """Time and value of a CSV file, whose first row may have names."""
    rows: list[list[float]] = []
    named = False
    try:
        with open(path, encoding="utf-8-sig") as file:
            for at, line in enumerate(file, 1):
                if not line.strip() or line.startswith("#"):
                    continue
                cells = line.split(",")
                try:
                    rows.append([float(cells[column]) * factor for column, factor in zip(columns, factors)])
                except (ValueError, IndexError):
                    # A name does not begin as a number does: 0.O2 is a mistake of a typist.
                    if rows or named or any(cell.strip(' "')[:1] in tuple("0123456789.+-") for cell in cells):
                        raise BadInput(f"{path}:{at}: columns {columns[0]} and {columns[1]} are not two numbers: correct the line, or give others "
                                       "with columns, [time, value], counted from 0") from None
                    named = True
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"the measured curve {path} cannot be read: {error}") from error
    return rows


def _measured(given: Any, here: pathlib.Path) -> Any:
    if isinstance(given, list):
        return given
    curve = mapping(given, "measured", 'a list of [time, value], or {"file": "curve.csv", "columns": [0, 1], "time": 1, "value": 1}',
                    ("file", "columns", "time", "value"), ("file",))
    columns, wanted = curve.get("columns", [0, 1]), "the columns of time and value, counted from 0, for example [0, 1]"
    if not isinstance(columns, list) or len(columns) != 2:
        raise BadInput(f"measured.columns is {_shown(columns)}: give {wanted}")
    columns = [whole_number(column, "measured.columns", 0, f": {wanted}") for column in columns]
    factors = [number(curve.get(name, 1), f"measured.{name}", wanted="the factor to s or the SI unit") for name in ("time", "value")]
    return _rows(here / text(curve["file"], "measured.file", "the name of a CSV file"), columns, (factors[0], factors[1]))


def read(path: pathlib.Path) -> dict[str, Any]:
    """The arguments of fit() in FIT.json, and label and unit; paths are made relative to it."""
    try:
        given = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"it cannot be read: {error}") from error
    asked = dict(mapping(given, "the file", 'an object: {"scene": ..., "parameters": ..., "measured": ..., "series": ...}', KEYS,
                         ("scene", "parameters", "measured", "series")))
    here = path.resolve().parent
    if isinstance(asked["scene"], str):
        asked["scene"] = here / asked["scene"]
    for key in ("series", "start"):
        if isinstance(asked.get(key), str) and ":" in asked[key]:
            asked[key] = str(here / asked[key])
    ranges = {}
    example = '{"fluid.viscosity": {"from": 1e-6, "to": 1e-2, "scale": "log"}}'
    for name, given in mapping(asked["parameters"], "parameters", example).items():
        r = mapping(given, f"parameters: {name}", '{"from": 1e-6, "to": 1e-2, "scale": "log"}', ("from", "to", "scale"), ("from", "to"))
        ranges[name] = (r["from"], r["to"], r.get("scale", "linear"))
    for key, instead in (("label", str(asked["series"]).rpartition(":")[2]), ("unit", "")):
        asked[key] = text(asked.get(key, instead), key, "a text")
    folder = here / text(asked.get("folder", path.stem), "folder", "the name of a folder")
    return {**asked, "parameters": ranges, "measured": _measured(asked["measured"], here), "folder": folder}
