"""The numbers of a scenario: finite, plain (true is not 1, "1" is not 1), and of sensible size."""

from typing import Annotated

from pydantic import AfterValidator, Field

LARGEST = 1e9  # beyond it a number is a slip, and its powers would leave float32


def _sensible(x: float) -> float:
    if abs(x) > LARGEST:
        raise ValueError(f"must be at most {LARGEST:g} in magnitude")
    return x + 0.0  # no -0.0: equal scenarios have equal digests


def _rising(bounds: tuple[float, float]) -> tuple[float, float]:
    if bounds[0] >= bounds[1]:
        raise ValueError("must be [low, high] with low below high")
    return bounds


Number = Annotated[float, Field(strict=True, allow_inf_nan=False), AfterValidator(_sensible)]
NonNegative = Annotated[Number, Field(ge=0)]
Positive = Annotated[Number, Field(gt=0)]

Point = tuple[Number, Number, Number]
Lengths = tuple[Positive, Positive, Positive]
Range = Annotated[tuple[Number, Number], AfterValidator(_rising)]
NonNegativeRange = Annotated[tuple[NonNegative, NonNegative], AfterValidator(_rising)]
Weights = tuple[NonNegative, NonNegative, NonNegative, NonNegative, NonNegative, NonNegative]
