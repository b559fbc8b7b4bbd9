"""The assembly from links against the study's equations of motion written out term by term."""

import numpy as np
import pytest
from hypothesis import given, settings

import models
import susp_ss as ss
from models import VEHICLES


def assert_same_matrices(vehicle):
    ours, theirs = vehicle.assemble(), models.oracle(vehicle)
    for mine, yours in (
        (np.diag(ours.m), theirs.M),
        (ours.C, theirs.C),
        (ours.K, theirs.K),
        (ours.C_in, theirs.C_in),
        (ours.K_in, theirs.K_in),
    ):
        np.testing.assert_allclose(mine, yours, rtol=1e-12, atol=1e-12 * np.abs(yours).max())


@pytest.mark.parametrize("vehicle", VEHICLES.values(), ids=VEHICLES.keys())
def test_matrices_are_those_of_the_equations(vehicle):
    assert_same_matrices(vehicle)


@given(models.full_cars)
@settings(max_examples=100)
def test_full_car_matrices_for_random_unequal_corners(vehicle):
    assert_same_matrices(vehicle)


@given(models.vehicles)
@settings(max_examples=50)
def test_natural_frequencies(vehicle):
    theirs = models.oracle(vehicle)
    eigenvalues = np.sort(np.linalg.eigvals(np.linalg.inv(theirs.M) @ theirs.K).real)
    np.testing.assert_allclose(vehicle.natural_frequencies(), np.sqrt(eigenvalues) / (2 * np.pi), rtol=1e-9)


def test_a_stack_of_designs_holds_each_design():
    cs = np.array([500.0, 1500.0, 2500.0])
    stack = ss.FullCar(cs=cs, arb_front=2e4).assemble()
    for i, one in enumerate(cs):
        single = ss.FullCar(cs=one, arb_front=2e4).assemble()
        for mine, yours in zip(stack.velocity_form(), single.velocity_form(), strict=True):
            np.testing.assert_array_equal(np.broadcast_to(mine, (3, *yours.shape))[i], yours)


def test_static_displacement_is_rigid_but_for_the_warp():
    model = ss.FullCar(**models.UNEQUAL).assemble()
    a, b, c = 0.961, 1.504, 0.723
    lever = np.array([[1, -a, -c], [1, -a, c], [1, b, -c], [1, b, c]])
    plane = lever @ [0.03, 0.01, -0.02]
    q = model.G @ plane
    np.testing.assert_allclose(q[:4], plane, rtol=1e-9)
    np.testing.assert_allclose(q[4:], [0.03, 0.01, -0.02], rtol=1e-9)
    np.testing.assert_allclose(model.integrators @ plane, 0.0, atol=1e-15)
