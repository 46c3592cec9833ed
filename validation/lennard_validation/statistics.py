"""Errors of correlated series, computed apart from the program's own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats


@dataclass(frozen=True)
class Blocked:
    """A mean and its standard error from independent blocks."""

    mean: float
    standard_error: float


def blocked_error(series, blocks: int = 25) -> Blocked:
    """The mean of a stationary series and its error from the scatter of consecutive blocks.

    The blocks must be long against the correlation time; their number leaves the error itself
    uncertain by 1/sqrt(2 (blocks - 1)), 14 % for 25 blocks.
    """
    series = np.asarray(series, dtype=float)
    length = len(series) // blocks
    if length < 2:
        raise ValueError(f"{len(series)} values are too few for {blocks} blocks")
    # The remainder is left out at the beginning, where the run still remembers its start.
    means = series[-blocks * length :].reshape(blocks, length).mean(axis=1)
    return Blocked(float(means.mean()), float(means.std(ddof=1) / np.sqrt(blocks)))


def chi_squared_of_spread(means, errors) -> tuple[float, float]:
    """Whether independent runs scatter as their standard errors say: chi squared about the weighted
    mean, and the probability of a smaller one if they do."""
    means = np.asarray(means, dtype=float)
    errors = np.asarray(errors, dtype=float)
    weights = errors**-2
    centre = np.average(means, weights=weights)
    chi_squared = float((((means - centre) / errors) ** 2).sum())
    return chi_squared, float(stats.chi2.cdf(chi_squared, len(means) - 1))
