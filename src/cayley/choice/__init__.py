"""The choice of rule and step for a wanted accuracy: trials over a window, costs measured on this machine."""

from cayley.choice.choose import Choice, Unreached, choose
from cayley.choice.settle import Alternative, Task

__all__ = ["Alternative", "Choice", "Task", "Unreached", "choose"]
