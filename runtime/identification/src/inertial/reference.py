"""Writes reference.txt: minima of consistent programs by Clarabel, for the tests of consistent.rs.

pip install numpy scipy clarabel; python reference.py > reference.txt

The same problems are drawn there, by the same generator (SplitMix64, uniform numbers only). Each line has a seed,
bodies, further entries, rows, the value of ½ xᵀ H x − gᵀ x, the lower bound of it that Clarabel reached, and x.
Clarabel sees H with entries near one: x is divided by the sizes that the problem was drawn with. With smaller
tolerances than these it stops further away.
"""

import clarabel
import numpy as np
from scipy import sparse

PROBLEMS = [(1, 1, 0, 40), (2, 1, 2, 12), (3, 2, 3, 60), (4, 3, 8, 60), (5, 4, 6, 300), (6, 6, 12, 100)]
MASK = (1 << 64) - 1


class SplitMix64:
    def __init__(self, seed):
        self.state = seed

    def uniform(self):
        self.state = (self.state + 0x9E3779B97F4A7C15) & MASK
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
        return ((z ^ (z >> 31)) >> 11) / 2.0**53


def pseudo_inertia(pi):
    m, hx, hy, hz, xx, xy, yy, xz, yz, zz = pi
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    j = np.zeros((4, 4))
    j[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    j[:3, 3] = j[3, :3] = [hx, hy, hz]
    j[3, 3] = m
    return j


def parameters(j):
    t = j[0, 0] + j[1, 1] + j[2, 2]
    return [j[3, 3], j[0, 3], j[1, 3], j[2, 3], t - j[0, 0], -j[0, 1], t - j[1, 1], -j[0, 2], -j[1, 2], t - j[2, 2]]


def body(random, mass, size):
    j = np.zeros((4, 4))
    centre = [size * (random.uniform() - 0.5) for _ in range(3)]
    for _ in range(8):
        x = np.array([c + size * (random.uniform() - 0.5) for c in centre] + [1.0])
        j += np.outer(x, x) * (mass / 8.0 * (0.5 + random.uniform()))
    return parameters(j)


def problem(seed, bodies, further, rows):
    random = SplitMix64(seed)
    truth, sizes = [], []
    for _ in range(bodies):
        mass, size = 10 ** (4 * random.uniform() - 2), 10 ** (2 * random.uniform() - 2.5)
        truth += body(random, mass, size)
        sizes += [mass] + [mass * size] * 3 + [mass * size * size] * 6
    for _ in range(further):
        size = 10 ** (4 * random.uniform() - 3)
        truth.append(size * (2 * random.uniform() - 1))
        sizes.append(size)
    n = len(truth)
    w = np.array([[2 * random.uniform() - 1 for _ in range(n)] for _ in range(rows)])
    sizes = np.array(sizes)
    tau = w @ (np.array(truth) / sizes) + np.array([6 * random.uniform() - 3 for _ in range(rows)])
    nonnegative = range(10 * bodies, n - further // 2)
    return w, tau, sizes, nonnegative


def solve(bodies, w, tau, sizes, nonnegative):
    n = w.shape[1]
    rows, cones = [], []
    for b in range(bodies):
        scale = sizes[10 * b : 10 * b + 10]
        t = np.array([np.sqrt(scale[4])] * 3 + [np.sqrt(scale[0])])
        images = [pseudo_inertia(scale * unit) / np.outer(t, t) for unit in np.eye(10)]
        for c in range(4):
            for r in range(c + 1):
                row = np.zeros(n)
                row[10 * b : 10 * b + 10] = [-(1.0 if r == c else np.sqrt(2)) * image[r, c] for image in images]
                rows.append(row)
        cones.append(clarabel.PSDTriangleConeT(4))
    for i in nonnegative:
        row = np.zeros(n)
        row[i] = -1.0
        rows.append(row)
    if len(nonnegative):
        cones.append(clarabel.NonnegativeConeT(len(nonnegative)))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-10
    settings.max_iter = 500
    hessian = sparse.csc_matrix(np.triu(w.T @ w))
    solver = clarabel.DefaultSolver(
        hessian, -w.T @ tau, sparse.csc_matrix(np.array(rows)), np.zeros(len(rows)), cones, settings
    )
    solution = solver.solve()
    return np.array(solution.x) * sizes, solution


if __name__ == "__main__":
    for seed, bodies, further, rows in PROBLEMS:
        w, tau, sizes, nonnegative = problem(seed, bodies, further, rows)
        x, solution = solve(bodies, w, tau, sizes, nonnegative)
        values = f"{float(solution.obj_val)!r} {float(solution.obj_val_dual)!r} "
        print(f"{seed} {bodies} {further} {rows} " + values + " ".join(f"{value:.9e}" for value in x))
