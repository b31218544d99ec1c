"""The leveling metrics of recorded runs once more, by NumPy and SciPy from the definitions in docs/leveling-metrics.md:
low-pass by scipy.ndimage, transport as a linear program for HiGHS. Usage: leveling_metrics_test.py SESSION..."""
import sys

import h5py
import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.optimize import linprog
from scipy.sparse import coo_matrix
from scipy.spatial import cKDTree

SIGMA_M = 0.05
BLOCKS = 24


class Surface:
    """Heights in metres on a square grid, row 0 in the south."""

    def __init__(self, dataset, grain_m):
        self.spacing = dataset.attrs["spacing_m"]
        self.wrap = bool(dataset.attrs["wrap"])
        unit = dataset.attrs["unit_m"]
        self.rounding = unit / self.spacing
        self.heights = dataset[:].astype(np.int64) * unit
        # Single stones of a bed of particles do not count; the filtered heights are of whole units again.
        if grain_m > 0:
            plane, low = self.low_pass(grain_m)
            self.heights = np.round((plane + low) / unit) * unit

    def mean_plane(self):
        ny, nx = self.heights.shape
        if self.wrap:
            return np.full((ny, nx), self.heights.mean())
        y, x = np.mgrid[0:ny, 0:nx] * self.spacing
        terms = np.column_stack([np.ones(nx * ny), x.ravel(), y.ravel()])
        factors, *_ = np.linalg.lstsq(terms, self.heights.ravel(), rcond=None)
        return (terms @ factors).reshape(ny, nx)

    def low_pass(self, sigma_m):
        plane = self.mean_plane()
        mode = "wrap" if self.wrap else "reflect"
        return plane, gaussian_filter(self.heights - plane, sigma_m / self.spacing, mode=mode, truncate=4.0)

    def flatness(self, heights, limit_deg):
        """Share of cells whose slope at their centre is within the limit."""
        if self.wrap:
            heights = np.pad(heights, ((0, 1), (0, 1)), mode="wrap")
        south_west, south_east = heights[:-1, :-1], heights[:-1, 1:]
        north_west, north_east = heights[1:, :-1], heights[1:, 1:]
        along_x = (south_east + north_east - south_west - north_west) / (2 * self.spacing)
        along_y = (north_west + north_east - south_west - south_east) / (2 * self.spacing)
        return np.mean(np.hypot(along_x, along_y) <= np.tan(np.radians(limit_deg)) + self.rounding)

    def blocks(self):
        """Centre and excess of each block, and the bound of the error."""
        ny, nx = self.heights.shape
        count = [min(n, max(1, int(np.floor(BLOCKS * n / max(nx, ny) + 0.5)))) for n in (nx, ny)]
        edges = [[k * n // c for k in range(c + 1)] for n, c in zip((nx, ny), count)]
        excess = (self.heights - self.heights.mean()) * self.spacing**2
        centres, volumes, bound = [], [], 0.0
        for y0, y1 in zip(edges[1], edges[1][1:]):
            for x0, x1 in zip(edges[0], edges[0][1:]):
                part = excess[y0:y1, x0:x1]
                centre = np.array([(x0 + x1 - 1) / 2, (y0 + y1 - 1) / 2])
                y, x = np.mgrid[y0:y1, x0:x1]
                bound += np.sum(np.abs(part) * np.hypot(x - centre[0], y - centre[1])) * self.spacing
                centres.append(centre * self.spacing)
                volumes.append(part.sum())
        return np.array(centres), np.array(volumes), bound

    def transport(self):
        """W1, its bound, and the square of W2."""
        centres, volumes, bound = self.blocks()
        total = volumes[volumes > 0].sum()
        if total == 0:
            return 0.0, bound, 0.0
        heaps, pits = np.flatnonzero(volumes > 0), np.flatnonzero(volumes < 0)
        apart = np.abs(centres[heaps][:, None, :] - centres[pits][None, :, :])
        if self.wrap:
            size = np.array(self.heights.shape[::-1]) * self.spacing
            apart = np.minimum(apart, size - apart)
        distance = np.hypot(apart[..., 0], apart[..., 1])
        heap, pit = np.indices(distance.shape)
        row = np.concatenate([heap.ravel(), len(heaps) + pit.ravel()])
        column = np.tile(np.arange(distance.size), 2)
        sums = coo_matrix((np.ones(row.size), (row, column))).tocsr()
        supply = np.concatenate([volumes[heaps], -volumes[pits]]) / total
        # One equation follows from the others; rounding must not make it contradict them.
        plans = [linprog(cost.ravel(), A_eq=sums[:-1], b_eq=supply[:-1], method="highs-ds")
                 for cost in (distance, distance**2)]
        assert all(plan.status == 0 for plan in plans), [plan.message for plan in plans]
        return plans[0].fun * total, bound, plans[1].fun * total

    def figures(self, limit_deg=5.0):
        plane, low = self.low_pass(SIGMA_M)
        w1, bound, w2 = self.transport()
        return {
            "level_deviation": (plane + low).std(),
            "relief": np.sqrt(np.mean(low**2)),
            "roughness": np.sqrt(np.mean((self.heights - plane - low) ** 2)),
            "robot_scale_flatness": self.flatness(plane + low, limit_deg),
            "flatness": self.flatness(self.heights, limit_deg),
            "height_deviation": self.heights.std(),
            "transport": w1,
            "transport_error": bound,
            "transport_squared": w2,
        }


def setting(text, name):
    """The value of a key that is in one section of the experiment alone."""
    values = [line.split("=")[1].strip() for line in text.splitlines() if line.split("=")[0].strip() == name]
    assert len(values) == 1, (name, values)
    return values[0]


def shares(frames, tread_m, limits):
    """Traversability from the recorded frames."""
    tracks = np.maximum(np.abs(frames["track_left"]), np.abs(frames["track_right"]))
    second = np.ones(100) / 100.0
    along = np.sign(frames["track_left"] + frames["track_right"]) * frames["velocity_x"]
    turning = np.sign(frames["track_right"] - frames["track_left"]) * frames["rate_z"] * tread_m / 2
    travelled = sum(np.abs(np.convolve(v, second, "valid")) for v in (along, turning))
    driven = np.convolve(tracks, second, "valid")
    running = tracks >= 0.03
    slip = (np.abs(frames["slip_left"]) + np.abs(frames["slip_right"])) / 2
    away = np.hypot(np.cumsum(frames["delta_x"]), np.cumsum(frames["delta_y"]))
    inclined = np.arccos(np.cos(frames["pitch"]) * np.cos(frames["roll"]))
    return {
        "stuck": np.sum((driven >= 0.03) & (travelled < 0.2 * driven)) / len(frames),
        "tilted": np.mean(inclined > np.radians(limits["tilt_limit"] / 100)),
        "off_site": np.mean(away > limits["site_radius"] / 1000) if limits["site_radius"] > 0 else 0.0,
        "returning": np.mean((frames["state"] == 2) & (frames["leveling_state"] == 4)),
        "slip": slip[running].mean() if running.any() else 0.0,
        "energy": frames["energy"][-1],
        "time": frames["time"][-1],
    }


def visited(frames, reach_m, radius_m, bed):
    """Share of the site's squares of 50 mm whose centres came under the robot; not a number where the site has no
    edge."""
    if bed.wrap and radius_m == 0:
        return np.nan
    start = np.array([frames["x"][0] - frames["delta_x"][0], frames["y"][0] - frames["delta_y"][0]])
    half = np.array(bed.heights.shape[::-1]) - 1
    half = np.full(2, np.inf) if bed.wrap else half * bed.spacing / 2
    reach = radius_m if radius_m > 0 else np.inf
    low, high = np.maximum(-half - start, -reach), np.minimum(half - start, reach)
    east, north = (l + 0.05 * (np.arange(np.floor((h - l) / 0.05 + 1e-6)) + 0.5) for l, h in zip(low, high))
    centres = np.column_stack([c.ravel() for c in np.meshgrid(east, north)])
    centres = centres[np.hypot(*centres.T) <= reach]
    path = np.column_stack([np.cumsum(frames["delta_x"]), np.cumsum(frames["delta_y"])])[::10]
    return np.mean(cKDTree(path).query(centres)[0] <= reach_m)


def check(name, got, expected, relative, absolute=1e-12):
    assert abs(got - expected) <= relative * abs(expected) + absolute, f"{name}: {got}, expected {expected}"


for path in sys.argv[1:]:
    with h5py.File(path) as session:
        text = session.attrs["experiment_text"]
        text = text.decode() if isinstance(text, bytes) else text
        particles = "\nmodel = particles\n" in text
        grain = float(setting(text, "particle_radius")) if particles else 0.0
        curve = session["leveling"][:]
        surfaces = [Surface(session["terrain"][name], grain).figures() for name in ("before", "after")]
        for point, expected in zip((curve[0], curve[-1]), surfaces):
            for name, value in expected.items():
                check(f"{path}: {name} at {point['time']} s", point[name], value, 1e-6, 1e-10)
        first, last = (surface["transport"] for surface in surfaces)
        check("progress", curve[-1]["progress"], 1 - last / first, 1e-6, 1e-6)
        check("per joule", curve[-1]["transport_per_joule"], (first - last) / session["frames"][-1]["energy"],
              1e-3, 1e-12)
        limits = {name: float(session["parameters"].attrs[name]) for name in ("tilt_limit", "site_radius")}
        tread = session["board"].attrs["tread_mm"] / 1000
        for name, value in shares(session["frames"][:], tread, limits).items():
            # A sum within rounding of a limit may count or not.
            check(f"{path}: {name}", curve[-1][name], value, 1e-9,
                  1.01 / len(session["frames"]) if name == "stuck" else 1e-12)
        part = visited(session["frames"][:], tread / 2, limits["site_radius"] / 1000,
                       Surface(session["terrain"]["before"], 0.0))
        assert np.isclose(curve[-1]["visited"], part, atol=0.002, equal_nan=True), (path, curve[-1]["visited"], part)
        print(f"{path}: {len(curve)} points; T {first * 1e3:.4f} -> {last * 1e3:.4f} L m, "
              f"R {surfaces[0]['relief'] * 1e3:.3f} -> "
              f"{surfaces[1]['relief'] * 1e3:.3f} mm, stuck {curve[-1]['stuck']:.3f}")
print(f"{len(sys.argv) - 1} sessions: every metric as SciPy has it")
