"""Draws a recorded run: the ground before and after, the robot's way, how level it became.

    python3 plot_run.py out/level_bed-0001 run.png
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import screed

run, picture = sys.argv[1:]
with screed.Session(run) as session:
    frames, level = session.frames, session.leveling
    before, after = session.ground_before, session.ground_after
    half = [0.5 * side * session.spacing for side in (before.shape[1] - 1, before.shape[0] - 1)]
limit = 1e3 * np.abs(before - before.mean()).max()
figure, axes = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
for axis, ground, title in ((axes[0], before, "before"), (axes[1], after, "after")):
    picture_of = axis.imshow(1e3 * (ground - ground.mean()), origin="lower", cmap="RdBu_r", vmin=-limit, vmax=limit,
                             extent=(-half[0], half[0], -half[1], half[1]))
    axis.set(title=title, xlabel="x [m]", ylabel="y [m]")
axes[1].plot(frames["x"], frames["y"], color="black", linewidth=0.4, alpha=0.6)
figure.colorbar(picture_of, ax=axes[:2], label="height about the mean [mm]")
axes[2].plot(level["time"] / 60, 1e3 * level["level_deviation"], label="height about level")
axes[2].plot(level["time"] / 60, 1e3 * level["relief"], label="relief, slant taken off")
axes[2].set(xlabel="time [min]", ylabel="RMS [mm]", ylim=(0, None))
axes[2].legend()
figure.savefig(picture, dpi=110)
