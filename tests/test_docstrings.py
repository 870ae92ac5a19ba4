"""Every public function has an example in its docstring, which pytest runs with the tests."""

import doctest
import inspect

import pytest

import analysis
import mbs_models

FUNCTIONS = {
    f"{package.__name__}.{name}": found
    for package in (analysis, mbs_models)
    for name in package.__all__
    if inspect.isfunction(found := getattr(package, name))
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_public_function_has_an_example(name: str) -> None:
    assert doctest.DocTestParser().get_examples(FUNCTIONS[name].__doc__ or "")
