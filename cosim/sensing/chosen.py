"""Choice of a run's sensing model and its parameters, from the scenario and the run's request."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cosim.errors import InputError
from cosim.sensing import catalog
from cosim.sensing.interface import Sensing

MODEL = "model"
PREFIX = "sensing."
"""Prefix for a sensing parameter whose name the controller or the scenario uses too."""
OTHERS_PREFIX = "other."
"""Prefix for the parameter of that name of the controller or the scenario."""


def name_in(table: Mapping[str, object]) -> str:
    """Return the name of the model that a scenario's table requests."""
    return str(table.get(MODEL, catalog.PERFECT))


def choose(
    table: Mapping[str, object], place: str, name: str | None, texts: Mapping[str, str]
) -> tuple[str, Sensing]:
    """Return the model's name and the model.

    Parameters
    ----------
    table : ``[sensing]`` of the scenario: ``model``, and parameters of any model; those that the model in
        use does not have only serve if another model is requested
    place : where that table is, for messages
    name : model that is requested instead of the scenario's
    texts : requested values of the model's parameters, by name

    Raises
    ------
    InputError
        One line: unknown model or parameter, or a value that is not possible.
    """
    said = {key: value for key, value in table.items() if key != MODEL}
    for key in said:
        if key not in catalog.all_parameters():
            exist = ", ".join([MODEL, *sorted(catalog.all_parameters())])
            raise InputError(f"{place}: [sensing] has the key '{key}'; keys that exist: {exist}")
    try:
        _check_scenario(name_in(table), said)
    except InputError as error:
        raise InputError(f"{place}: {error}") from error
    chosen = name_in(table) if name is None else name
    known = catalog.parameters(chosen)
    kept = {key: value for key, value in said.items() if key in known}
    return chosen, catalog.build(chosen, {**kept, **texts})


def split(
    texts: Mapping[str, str], model: str, others: Iterable[str]
) -> tuple[dict[str, str], dict[str, str]]:
    """Return the parameters of the sensing model, and the remaining ones.

    Parameters
    ----------
    texts : names and values; a name may begin with ``sensing.`` or ``other.``
    model : name of the sensing model
    others : names of the controller's and the scenario's parameters

    Raises
    ------
    InputError
        If a name is that of a parameter of both.

    Examples
    --------
    >>> split({"range_m": "40", "headway_s": "2"}, "onboard", ("headway_s",))
    ({'range_m': '40'}, {'headway_s': '2'})
    """
    known, others = catalog.parameters(model), set(others)
    own: dict[str, str] = {}
    rest: dict[str, str] = {}
    for key, text in texts.items():
        if key.startswith(PREFIX):
            own[key.removeprefix(PREFIX)] = text
        elif key.startswith(OTHERS_PREFIX):
            rest[key.removeprefix(OTHERS_PREFIX)] = text
        elif key in known and key in others:
            raise InputError(
                f"--set {key}: sensing '{model}' has it, and so has the controller or the scenario; "
                f"expected {PREFIX}{key} or {OTHERS_PREFIX}{key}"
            )
        elif key in known:
            own[key] = text
        else:
            rest[key] = text
    return own, rest


def _check_scenario(model: str, said: Mapping[str, object]) -> None:
    """Build every model with its parameters in the table, to find mistakes also for models not in use."""
    catalog.parameters(model)
    for name in catalog.names():
        known = catalog.parameters(name)
        catalog.build(name, {key: value for key, value in said.items() if key in known})
