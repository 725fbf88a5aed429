"""Whether the parameters of a study name numbers and words of its presets, and what a person may have meant."""

import difflib
from typing import Any, Literal, get_args, get_origin, get_type_hints

from rangenav import field_path
from rangenav.inputs import Input, require
from rangenav.preset import Preset
from rangenav.studies import file_errors
from rangenav.studies.parameters import DERIVED, Choices, Listed, Parameter

WORD = 'a word; kind = "choices" varies it'
NUMBER = 'a number; kind = "list", "linear" and others vary it'


def refuse_unknown(parameters: tuple[Parameter, ...], bases: tuple[Preset, ...]) -> None:
    """Raise ValueError if a parameter names no number, or no word, of one of the presets."""
    for k, parameter in enumerate(parameters):
        if parameter.path in DERIVED:
            require(not isinstance(parameter, Choices), f"parameters.{k + 1}: {parameter.path} takes numbers")
            least = min(parameter.values) if isinstance(parameter, Listed) else getattr(parameter, "low", 1.0)
            require(least > 0, f"parameters.{k + 1}: {parameter.path} must be positive, got {least:g}")
            continue
        for base in bases:
            try:
                if isinstance(parameter, Choices):
                    field_path.word(base, parameter.path)
                else:
                    field_path.value(base, parameter.path)
            except ValueError as error:
                raise ValueError(f"parameters.{k + 1}: path {_reason(error, parameter, base)}") from None
            if isinstance(parameter, Choices):
                _refuse_words(parameter, base, k)


def _refuse_words(parameter: Choices, base: Preset, k: int) -> None:
    """Raise ValueError if the preset allows only certain words, and one of the parameter's is none of them."""
    *above, last = parameter.path.split(".")
    owner = _owner(base, above)
    hint = get_type_hints(type(owner)).get(last) if isinstance(owner, Input) else None
    if get_origin(hint) is Literal:
        for one in parameter.values:
            require(
                one in get_args(hint), f"parameters.{k + 1}: {parameter.path}: {file_errors.near(one, get_args(hint))}"
            )


def _owner(of: Any, parts: list[str]) -> Any:
    """The value at a path; None if there is none."""
    for part in parts:
        if isinstance(of, tuple):
            index = field_path.COMPONENTS.get(part, int(part) - 1 if part.isdecimal() else -1)
            of = of[index] if 0 <= index < len(of) else None
        else:
            of = getattr(of, part, None)
    return of


def _reason(error: ValueError, parameter: Parameter, base: Preset) -> str:
    """Why a path is wrong, and the paths of the preset that look like it."""
    path, known = parameter.path, [*DERIVED, *field_path.paths(base)]
    *above, last = path.split(".")
    if path in known:
        return f"{path}: {NUMBER if isinstance(parameter, Choices) else WORD}"
    owner = _owner(base, above)
    if last in getattr(owner, "__struct_fields__", ()) and getattr(owner, last) is None:
        return f"{path}: the preset {base.title!r} states none; write a value into its file to vary it"
    first = path.split(".")[0]
    words = str(error) if first in base.__struct_fields__ else f"{path}: there is no {first}"
    same = [one for one in known if one.split(".")[-1] == last or (len(last) > 1 and last in one)]
    same.sort(key=lambda one: -difflib.SequenceMatcher(None, one, path).ratio())
    likely = difflib.get_close_matches(path, known, 3) or same[:3]
    return f"{words}; did you mean {' or '.join(likely)}?" if likely else words
