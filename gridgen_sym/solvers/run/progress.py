"""Report the steps of a solver: history, the user's callback, and a line on the terminal when it takes long."""

from __future__ import annotations

from collections.abc import Callable

from .deadline import Deadline, StopRequest
from .live import LiveLine
from .result import Step
from .status import StopReason

Callback = Callable[[Step], None]


class Progress(LiveLine):
    """Collects the history, and shows it step by step.

    Attributes:
        history: the steps of the last stage.
        deadline: of the run; every long-running stage between two steps checks it.
        callback_error: what the user's callback has raised, if anything.
    """

    def __init__(
        self,
        title: str,
        callback: Callback | None = None,
        show: bool | None = None,
        deadline: Deadline | None = None,
    ) -> None:
        """Begin.

        Args:
            title: what is being done.
            callback: called with every `Step`; may raise StopIteration to end the solver.
            show: show progress on standard error; by default, if that is a terminal.
            deadline: when the solver must end; never by default.
        """
        super().__init__(title, show)
        self.history: list[Step] = []
        self._stage, self._shape = "start", (0, 0)
        self.callback_error: Exception | None = None
        self._callback, self.deadline = callback, deadline or Deadline()

    def begin(self, stage: str, shape: tuple[int, int]) -> None:
        """Begin a stage on a grid of a shape; the history is that of the last stage."""
        self._stage, self._shape = stage, shape
        self.history.clear()

    def step(self, iteration: int, energy: float, gradient_norm: float, min_jacobian: float) -> None:
        """Record one step; call the callback and update the line on the terminal.

        Raises:
            StopRequest: if the callback asks for it, or the time is over.
        """
        # These stages solve many problems: the steps of all are counted through.
        number = len(self.history) if self._stage in ("untangle", "control") else iteration
        step = Step(number, energy, gradient_norm, min_jacobian, self._stage, self._shape)
        self.history.append(step)
        self._call(step)
        self.display(
            f"{step.stage} {step.shape[0]} x {step.shape[1]}, iteration {step.iteration}, energy {step.energy:.6g}, "
            f"gradient {step.gradient_norm:.2e}, smallest J {step.min_jacobian:.2e}"
        )
        self.deadline.check()

    def _call(self, step: Step) -> None:
        if self._callback is None:
            return
        try:
            self._callback(step)
        except StopIteration:
            raise StopRequest(StopReason.CALLBACK, "the callback stopped it") from None
        except Exception as error:
            self.callback_error = error
            raise
