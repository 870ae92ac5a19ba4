"""The examples in docstrings run and print what they say."""

import doctest
import inspect
import pkgutil
from importlib import import_module

import pytest

import analysis
import mbs_models

PUBLIC = {
    f"{package.__name__}.{name}": getattr(package, name)
    for package in (analysis, mbs_models)
    for name in package.__all__
}
FUNCTIONS = {name: found for name, found in PUBLIC.items() if inspect.isfunction(found)}
MODULES = [
    found.name
    for package in (analysis, mbs_models)
    for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_public_function_has_an_example(name: str) -> None:
    assert doctest.DocTestParser().get_examples(FUNCTIONS[name].__doc__ or "")


@pytest.mark.parametrize("name", MODULES)
def test_examples_say_what_comes_out(name: str) -> None:
    found = doctest.testmod(import_module(name), optionflags=doctest.ELLIPSIS)
    assert found.failed == 0
