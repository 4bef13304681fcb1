"""95 % intervals, as the pages of docs/ print them."""

import math

Z = 1.959963984540054  # 97.5 % of a normal distribution lie below


def wilson(right, count, digits=2):
    """`right` of `count` in %, with Wilson's score interval in brackets."""
    p = right / count
    middle = (p + Z * Z / (2 * count)) / (1 + Z * Z / count)
    half = Z / (1 + Z * Z / count) * math.sqrt(p * (1 - p) / count + Z * Z / (4 * count**2))
    low, high = max(middle - half, 0), min(middle + half, 1)
    return f"{100 * p:.{digits}f} ({100 * low:.{digits}f} to {100 * high:.{digits}f})"
