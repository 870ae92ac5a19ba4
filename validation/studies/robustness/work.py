"""A limit on the work of a run that is the same on every machine: its number of steps."""


class WorkLimitError(Exception):
    """A run has taken all the steps it may take."""


class StepCount:
    """Counts the steps of a call, whatever passes it makes, and ends it after so many.

    To be handed over as `progress`.

    Parameters
    ----------
    limit : int
        Number of steps.

    Attributes
    ----------
    steps : int
        Steps so far.
    reached : float
        Time in s that the last pass has reached.
    """

    def __init__(self, limit: int) -> None:
        self.limit = limit
        self.steps = 0
        self.reached = 0.0

    @property
    def is_used_up(self) -> bool:
        """Whether the limit has ended the call, in whatever error it ended."""
        return self.steps > self.limit

    def __call__(self, reached: float, _end: float) -> None:
        """Count a step of a pass that has come to `reached` in s."""
        self.steps += 1
        if self.is_used_up:
            raise WorkLimitError(f"{self.limit} steps taken")
        self.reached = reached
