"""Minimax coefficients of the polynomials in this folder: Remez exchange with 60 digits (mpmath), no external table.

usage: python3 minimax.py        (needs mpmath)

Each polynomial P minimizes the largest |weight(t) (P(t) - target(t))| on its interval; from the leading coefficient on,
each one is rounded to f64 or f32 before the rest is fitted again, so that rounding costs nothing.
"""
import struct

from mpmath import mp, mpf, matrix, lu_solve, sin, cos, exp, sqrt, pi, log, chebyt, taylor

mp.dps = 60


def series(terms):
    """Sum of a power series given by its coefficients: targets stay accurate at t = 0."""
    return lambda t: mp.polyval(terms[::-1], t)


def fit(target, weight, low, high, degree, fixed=()):
    """Remez exchange for the coefficients after the fixed ones; returns them and the weighted error."""
    first, count = len(fixed), degree + 1 - len(fixed)
    points = [(low + high) / 2 - (high - low) / 2 * mp.cos(pi * (2 * k + 1) / (2 * count + 2)) for k in range(count + 1)]
    rest = lambda t: target(t) - mp.polyval(list(fixed)[::-1] or [0], t)
    for _ in range(8):
        system = matrix(count + 1, count + 1)
        values = matrix(count + 1, 1)
        for row, t in enumerate(points):
            for j in range(count):
                system[row, j] = t ** (first + j)
            system[row, count] = (-1) ** row / weight(t)
            values[row] = rest(t)
        solution = lu_solve(system, values)
        found = [solution[j] for j in range(count)]
        error = lambda t: weight(t) * (rest(t) - sum(c * t ** (first + j) for j, c in enumerate(found)))
        points, worst = extrema(error, low, high, count + 1)
    return found, worst


def extrema(error, low, high, count):
    """The `count` alternating extrema of the error, on a grid of Chebyshev nodes."""
    grid = [(low + high) / 2 - (high - low) / 2 * mp.cos(pi * k / 600) for k in range(601)]
    samples = [(t, error(t)) for t in grid]
    groups = []
    for t, e in samples:
        if groups and (groups[-1][1] > 0) == (e > 0):
            if abs(e) > abs(groups[-1][1]):
                groups[-1] = (t, e)
        else:
            groups.append((t, e))
    while len(groups) > count:
        groups.pop(0 if abs(groups[0][1]) < abs(groups[-1][1]) else -1)
    return [t for t, _ in groups], max(abs(e) for _, e in groups)


def single(value):
    """The nearest f32."""
    return struct.unpack("f", struct.pack("f", float(value)))[0]


def print_polynomial(name, target, weight, low, high, degree, rounded=float):
    fixed, (found, worst) = [], fit(target, weight, low, high, degree)
    while len(fixed) < degree and low == 0:  # the powers left after a fixed one are no Chebyshev system across zero
        fixed.append(mpf(rounded(found[0])))
        found, worst = fit(target, weight, low, high, degree, fixed)
    fixed += found
    print(f"{name}: weighted error 2^{mp.nstr(log(worst, 2), 5)} on [{mp.nstr(low, 6)}, {mp.nstr(high, 6)}]")
    for c in fixed:
        print(f"    {mp.nstr(mpf(rounded(c)), 9) if rounded is single else repr(float(c))},")


def alternating(first, count):
    """(-1)^k / (2 k + first)!, k = 0, 1, …"""
    return [(-1) ** k / mp.factorial(2 * k + first) for k in range(count)]


quarter = (pi / 4 * (1 + mpf(2) ** -20)) ** 2
half_log = log(2) / 2 * (1 + mpf(2) ** -20)
near_square = lambda r: r * r + mpf("0.02")  # r^2 counts; a weight must not vanish inside the interval
# sin r = r - r^3 P(r^2), relative error; cos r = 1 - r^2/2 + r^4 P(r^2); exp r = 1 + r + r^2 P(r)
print_polynomial("sin", series(alternating(3, 20)), lambda z: z, mpf(0), quarter, 5)
print_polynomial("cos", series(alternating(4, 20)), lambda z: z * z, mpf(0), quarter, 5)
print_polynomial("exp", series([1 / mp.factorial(k + 2) for k in range(40)]), near_square, -half_log, half_log, 9)
# The quotient x 2/pi of 400 has an error of 2^-16 quarters in f32.
quarter = (pi / 4 * (1 + mpf(2) ** -14)) ** 2
print_polynomial("sin f32", series(alternating(3, 20)), lambda z: z, mpf(0), quarter, 2, single)
print_polynomial("cos f32", series(alternating(4, 20)), lambda z: z * z, mpf(0), quarter, 2, single)
print_polynomial("exp f32", series([1 / mp.factorial(k + 2) for k in range(40)]), near_square, -half_log, half_log, 4, single)


def parts(name, value, bits, count, rounded=float):
    """Cody-Waite parts: truncated to `bits` bits each, the last rounded to f64 or f32."""
    out = []
    for k in range(count):
        left = value - sum(out)
        step = mpf(2) ** (mp.floor(log(left, 2)) + 1 - bits)
        out.append(mp.floor(left / step) * step if k + 1 < count else mpf(rounded(left)))
    print(name, [float(p).hex() for p in out], [repr(float(p)) for p in out], "left", mp.nstr(value - sum(out), 5))


parts("pi/2", pi / 2, 37, 3)
parts("ln 2", log(2), 42, 2)
parts("pi/2 f32", pi / 2, 16, 3, single)
parts("ln 2 f32", log(2), 16, 2, single)
mp.prec = 1400
words = int(mp.floor(2 / pi * mpf(2) ** (64 * 20)))
print("2/pi", [f"0x{(words >> 64 * (19 - k)) & (2**64 - 1):016x}" for k in range(20)])
