"""Orders, options and counts of integrators, and stability as measured on the engine itself."""

from functools import partial
from itertools import product
from typing import Any

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import pytest

import mbs_models
from analysis import PowerLawCoulomb, Scenario, SmoothCoulomb, Start, Table
from analysis.problem.variations import changed
from mbs_models import ACCELERATED, Formulation, Integrator, Newton, Scene
from mbs_models.integrators import STABILITY, largest_step
from mbs_models.runs import force_rounding
from mbs_models.scene import build
from mbs_models.solving import quiet
from tests.scenes import LOADED, SHORT, TIMES, scene_of, truth
from validation.comparison.differences import deviation

HELD: list[Formulation] = ["euler-tree", "floating", "floating-lie"]


def dopri5(tolerance: float) -> Integrator:
    return Integrator(name="DOPRI5", local_tolerance=tolerance)


@pytest.mark.parametrize(("integrator", "coefficients"), STABILITY.items())
def test_stability_functions_are_those_of_the_engine(
    integrator: str, coefficients: list[float]
) -> None:
    # A chain of variables, each of which drives the next: the matrix to the power k moves the
    # first unit vector by k places, so that a step makes it the list of the coefficients.
    size, container = len(coefficients), exu.SystemContainer()
    chain = container.AddSystem()
    start = {"referenceCoordinates": [0.0] * size, "initialCoordinates": np.eye(size)[0]}
    node = chain.AddNode(items.NodeGenericODE1(numberOfODE1Coordinates=size, **start))
    matrix = np.eye(size, k=-1)
    chain.AddObject(items.ObjectGenericODE1(nodeNumbers=[node], systemMatrix=matrix))
    chain.Assemble()
    settings = quiet()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 1, 1.0
    chain.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, integrator))
    np.testing.assert_allclose(chain.systemData.GetODE1Coordinates(), coefficients, atol=1e-15)


def test_stability_limit_of_the_classical_method_is_the_known_one() -> None:
    assert largest_step("RK44", -200.0) == pytest.approx(2.785 / 200.0, rel=1e-3)
    assert largest_step("RK44", 1.0j) == pytest.approx(2.828, abs=2e-3)


@pytest.mark.parametrize(
    ("scene", "integrator", "step", "order", "off"),
    [
        (Scene(), "RK44", 2.5e-3, 4, 0.3),
        (Scene(), "RK67", 5e-3, 6, 0.3),
        (Scene(), "TrapezoidalIndex2", 2.5e-3, 2, 0.3),
        # The contact force as load costs no order.
        (scene_of(3, "floating", friction=LOADED), "TrapezoidalIndex2", 2e-3, 2, 0.1),
        (scene_of(3, "euler-tree", friction=LOADED), "TrapezoidalIndex2", 2e-3, 2, 0.1),
        *(
            (scene_of(2, each), Integrator(name="GeneralizedAlpha", spectral_radius=radius),
             2.5e-3, 2, 0.4)
            for each in HELD
            for radius in (0.6, 0.9)
        ),
    ],
)  # fmt: skip
def test_observed_order_is_that_of_the_integrator(
    scene: Scene, integrator: Any, step: float, order: int, off: float
) -> None:
    run = partial(mbs_models.simulate, scene, TIMES, integrator=integrator)
    expected = truth(scene.scenario, TIMES)
    coarse, fine = (deviation(run(step=size), expected) for size in (step, step / 2))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=off)


@pytest.mark.parametrize(
    ("scene", "integrator", "tolerance", "most"),
    [
        # By another order the estimate would ask for three halvings more.
        *((scene_of(2, "euler-tree"), name, 1e-7, 4e3)
          for name in ("TrapezoidalIndex2", "GeneralizedAlpha")),
        # Newton's iteration is the same at every step, and yet so fine a tolerance is kept.
        (scene_of(2, "floating", start=Start(spin=30.0, gamma=0.3, beta=1.2)),
         "TrapezoidalIndex2", 1e-11, 1e4),
        *(pytest.param(each, "TrapezoidalIndex2", finest, most, marks=pytest.mark.slow)
          for each, finest, most in (
              (scene_of(1, "euler-tree", start=Start(spin=20.0, gamma=0.3, beta=1.2)), 1e-11, 1e4),
              # Rounding, which differs by processor, may leave 1.4e-12.
              (scene_of(3, "floating"), 3e-12, 2e4),
          )),
    ],
)  # fmt: skip
def test_implicit_steps_are_extrapolated_by_the_orders_of_their_error(
    scene: Scene, integrator: Any, tolerance: float, most: float
) -> None:
    run = mbs_models.simulate(scene, TIMES, tolerance=tolerance, integrator=integrator)
    assert deviation(run, truth(scene.scenario, TIMES)) < tolerance
    assert run.counts["steps"] < most


def test_a_slower_world_takes_as_many_steps() -> None:
    steps = []
    for slower in (1.0, 100.0):
        scenario = Scenario(
            table=Table(gravity=9.81 / slower**2),
            friction=SmoothCoulomb(smoothing=0.1 / slower),
            start=Start(spin=40.0 / slower),
        )
        run = mbs_models.simulate(scenario, slower * TIMES, tolerance=1e-6, integrator="RK67")
        steps.append(run.counts["steps"])
    assert steps[0] == steps[1]


CONTROLLED: list[tuple[Any, ...]] = [
    *product(ACCELERATED, ("contact-tree", "euler-tree")),
    ("DOPRI5", "contact-tree"),
]


@pytest.mark.parametrize(("name", "formulation"), CONTROLLED)
def test_a_local_tolerance_makes_a_single_run_and_a_step_limits_those_of_any(
    name: Any, formulation: Any
) -> None:
    run = partial(mbs_models.simulate, scene_of(1, formulation), SHORT)
    ways = [Integrator(name=name, local_tolerance=local) for local in (1e-4, 1e-10)]
    coarse, fine = (run(integrator=way) for way in ways)
    assert fine.error_estimate is None
    assert fine.method["local_tolerance"] == 1e-10
    expected = truth(Scenario(), SHORT)
    assert deviation(fine, expected) < min(1e-9, 1e-2 * deviation(coarse, expected))
    held = [(run(integrator=ways[0], step=1e-3), 200)]
    if name in ACCELERATED:
        # A tolerance takes two runs.
        held.append((run(integrator=name, tolerance=1e-4, step=1e-3), 400))
    for each, least in held:
        assert each.counts["steps"] >= least > coarse.counts["steps"]
        assert each.method["step"] == 1e-3


@pytest.mark.parametrize("name", ["RK67", "DOPRI5", "TrapezoidalIndex2"])
@pytest.mark.parametrize("spacings", [[1e-10] * 4, [1e-13] * 4, [1e-6, 2e-11]], ids=str)
def test_runs_reach_an_end_however_near_the_last_record_before_it(
    name: Any, spacings: list[float]
) -> None:
    times = np.cumsum([0.0, *spacings])
    ways: list[dict[str, Any]] = [{"step": 1e-4}]
    ways += [] if name == "DOPRI5" else [{"tolerance": 1e-8}]
    for wanted in ways:
        run = mbs_models.simulate(Scene(), times, integrator=name, **wanted)
        assert run.ending is None
        np.testing.assert_array_equal(run.times, times)
        assert run.counts["steps"] < 1e3
        # What the rates at the start make of it.
        moved = np.array(run.rates[0]) * times[:, None]
        assert np.abs(run.coordinates - run.coordinates[0] - moved).max() < 1e-9


def test_counts_of_explicit_runs_are_those_of_their_stages() -> None:
    counts = mbs_models.simulate(Scene(), TIMES, step=1e-2, integrator="RK44").counts
    assert (counts["steps"], counts["right_hand_sides"]) == (50, 4 * 50)
    controlled = mbs_models.simulate(Scene(), TIMES, integrator=dopri5(1e-8)).counts
    tried = controlled["steps"] + controlled["rejected_steps"]
    assert controlled["right_hand_sides"] == 7 * tried


def test_options_of_an_integrator_change_the_run_and_go_with_it() -> None:
    scene, weights = scene_of(1, "floating-lie"), Newton(absolute=1e-6)
    heavy = Scene(changed(scene.scenario, {"disk.density": 1e6}), "floating-lie")
    run = partial(mbs_models.simulate, times=TIMES, step=5e-3)
    usual, tight = (
        run(scene, integrator=each) for each in ("GeneralizedAlpha", "TrapezoidalIndex2")
    )
    damped = run(scene, integrator=Integrator(name="GeneralizedAlpha", spectral_radius=0.6))
    loose, fair, other = (
        run(each, integrator=Integrator(name="TrapezoidalIndex2", newton=newton))
        for each, newton in ((scene, Newton(relative=1e-4)), (scene, weights), (heavy, weights))
    )
    assert deviation(usual, damped) > 1e-6
    assert [run.method["spectral_radius"] for run in (usual, damped)] == [0.9, 0.6]
    taken = [each.counts["newton_iterations"] for each in (loose, fair, other, tight)]
    assert taken[0] < taken[1] == taken[2] < taken[3]
    assert deviation(tight, loose) > 1e-9


@pytest.mark.parametrize("spin", [3.0, 40.0, 150.0])
@pytest.mark.parametrize("formulation", HELD)
@pytest.mark.parametrize("level", [2, 3, 4])
def test_newtons_limit_lies_where_rounding_does(level: Any, formulation: Any, spin: float) -> None:
    start = Start(beta=1.2, spin=spin, beta_rate=0.3 * spin)
    scene = scene_of(level, formulation, start=start)
    strict = Integrator(name="TrapezoidalIndex2", newton=Newton(modified=False, relative=1e-30))
    # Below the limit nothing but rounding is left, so that no further iteration is needed.
    run = mbs_models.simulate(
        scene, [0.0, 1e-4, 2e-4], step=1e-4, integrator=strict, allow_pulling=True
    )
    assert run.counts["newton_iterations"] <= 8 * run.counts["steps"]
    assert force_rounding(build(scene)) < 1e-11 * scene.scenario.weight


@pytest.mark.parametrize("formulation", HELD)
def test_friction_out_of_proportion_to_its_load_breaks_no_run_of_full_newton_off(
    formulation: Formulation,
) -> None:
    scene = scene_of(1, formulation, friction=PowerLawCoulomb(load="contact"))
    full = Integrator(name="TrapezoidalIndex2", newton=Newton(modified=False))
    run = mbs_models.simulate(scene, np.linspace(0.0, 0.2, 5), step=1e-2, integrator=full)
    assert run.ending is None


def test_newton_converges_where_friction_under_the_contact_force_is_strong() -> None:
    strong = SmoothCoulomb(coefficient=3.0, load="contact")
    scene = scene_of(3, "floating", friction=strong, start=Start(spin=300.0))
    run = mbs_models.simulate(scene, [0.0, 1e-3], step=1e-5, integrator="GeneralizedAlpha")
    # Without the Jacobian's column for that force it breaks off within a millisecond,
    assert run.ending is None
    scene = scene_of(2, "floating", friction=strong, start=Start(beta=1.2, gamma=0.3, spin=30.0))
    full = Integrator(name="TrapezoidalIndex2", newton=Newton(modified=False))
    run = mbs_models.simulate(scene, [0.0, 0.01, 0.02], step=1e-3, integrator=full)
    # and so with a Jacobian that is renewed.
    assert run.counts["newton_iterations"] < 150
