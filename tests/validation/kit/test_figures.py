"""What figures share."""

from math import pi

from validation.kit.figures import pi_label


def test_multiples_of_a_quarter_of_pi_are_told_as_fractions() -> None:
    told = [pi_label(quarters * pi / 4) for quarters in (-4, -3, -1, 0, 1, 2, 3, 4, 6, 8)]
    assert told == ["−π", "−3π/4", "−π/4", "0", "π/4", "π/2", "3π/4", "π", "3π/2", "2π"]
