"""Try a wheel as a stranger would: alone in an environment of its own, far from the checkout.

Usage: python try_wheel.py WHEEL. Versions are those of PIP_CONSTRAINT, if that is set.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

PROGRAM = """
import numpy as np, pandas as pd, xarray as xr, susp_ss as ss
assert xr.open_dataset("results/responses.nc").VB.shape == (4, 4, 3)
ks, cs = np.random.default_rng(0).uniform([13e3, 900.0], [24e3, 2200.0], (12, 2)).T
bacc = ss.ride_metrics(ss.FullCar(ks=ks, cs=cs), ss.Road()).bacc.sel(point="fr")
pd.DataFrame({"ks": ks, "cs": cs, "bacc": bacc}).to_csv("runs.csv", index=False)
"""


def main(wheel):
    """Install the wheel and use it."""
    with tempfile.TemporaryDirectory(prefix="susp_ss-wheel-") as scratch:
        home = Path(scratch)
        environment = home / "environment"
        venv.create(environment, with_pip=True)
        python = environment / ("Scripts" if os.name == "nt" else "bin") / "python"
        clean = {name: text for name, text in os.environ.items() if name not in ("PYTHONPATH", "NUMBA_CACHE_DIR")}

        def run(line):
            """Run a command line in a folder of its own; return stdout and stderr."""
            begun, shell = time.perf_counter(), isinstance(line, str)
            done = subprocess.run(line, capture_output=True, text=True, cwd=home, env=clean, shell=shell)
            shown = line if shell else " ".join(["python", *line[1:]])
            print(f"{time.perf_counter() - begun:6.1f} s  {shown.strip().splitlines()[0]}", flush=True)
            if done.returncode:
                sys.exit(f"exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
            return done.stdout, done.stderr

        def susp_ss(line, said=""):
            """Run a command that says one line on stderr, or nothing; return stdout."""
            out, err = run([str(python), "-m", "susp_ss", *line.split()])
            if said not in err or len(err.splitlines()) != bool(said):
                sys.exit(f"needs {repr(said) if said else 'nothing'} on stderr, got\n{err}")
            return out

        def made(folder, *names):
            missing = [name for name in names if not (home / folder / name).is_file()]
            if missing:
                sys.exit(f"{folder} lacks {', '.join(missing)}")

        run([str(python), "-m", "pip", "install", "--quiet", "--no-compile", str(Path(wheel).resolve())])
        examined = json.loads(susp_ss("doctor --json"))
        if not Path(examined["package"]).is_relative_to(environment.resolve()):
            sys.exit(f"the package is that of {examined['package']}")
        installed = [name for name, extra in examined["extras"].items() if not extra["missing"]]
        if "fast" in installed or "netcdf" in installed:
            sys.exit(f"the core should not bring the extras {', '.join(installed)}")

        (home / "car.toml").write_text(susp_ss("metrics --template"), encoding="utf-8")
        json.loads(susp_ss("metrics --vehicle car.toml --ks 20000 --json"))
        susp_ss("study --nodes 4 --no-figures --out results", said="report.html needs plotly")
        made("results", "tables.csv", "tables.json", "responses.nc")
        run([str(python), "-c", PROGRAM])

        # The hint is a command that works.
        run(f"{examined['extras']['pages']['install']} --quiet --no-compile")
        susp_ss("study --nodes 4 --out results --force")
        made("results", "report.html", "figures/bode_magnitude.png")
        fitted = susp_ss("fit runs.csv --inputs ks,cs --outputs bacc --at fr --json --out fit")
        if json.loads(fitted)["outputs"]["bacc"]["not_fitted"]:
            sys.exit("every surrogate should be fitted")
        made("fit", "surrogate.json", "report.md", "report.html")
        json.loads(susp_ss("predict fit/surrogate.json --at ks=18000,cs=1500 --json"))


if __name__ == "__main__":
    main(*sys.argv[1:])
