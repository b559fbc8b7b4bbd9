"""What people type by mistake, by German, American and SI habits: each is refused in one line that says what to type.

The lines were collected from habits: units left out or mistaken, decimal commas, names of other tools, ranges turned
round. None may give a number, a traceback, or a file.
"""

import json

import control as ct
import numpy as np
import pandas as pd
import pytest

import susp_ss as ss
from susp_ss.fit.surrogate_file import SuspensionSurrogate
from susp_ss.vehicles.files import read_vehicle, vehicle_text

COMMANDS = [
    ("metrics --ks 24", "did you mean 24 N/mm"),
    ("metrics --ks 24.0", "did you mean 24 N/mm"),
    ("metrics --ks 18,5", "decimal comma; write 18.5"),
    ("metrics --ks 18.553,0", "needs a number"),
    ("metrics --ks 18'553", "needs a number"),
    ("metrics --ks 18_553", "needs a number"),
    ("metrics --ks 24kN", "no unit 'kN' of spring stiffness, available: N/m"),
    ("metrics --ks 24Nm", "no unit 'Nm'"),
    ("metrics --ks 24N/cm", "no unit 'N/cm'"),
    ("metrics --ks soft", "--ks: needs a number"),
    ("metrics --ks=", "--ks: needs a number"),
    ("metrics --ks=-18553", "--ks must be > 0 N/m, got -18553.0"),
    ("metrics --ks 0", "--ks must be > 0 N/m"),
    ("metrics --ks nan", "--ks must be finite"),
    ("metrics --ks inf", "--ks must be finite"),
    ("metrics --ks 12e3:24e3:10", "--ks"),
    ("metrics --ks 1e9", "outside the usual range of spring stiffness"),
    ("metrics --ks 105lbf", "no unit 'lbf'"),
    ("metrics --ks 24000N/mm", "did you mean 24000 N/m"),
    ("metrics --cs 1.5", "did you mean 1.5 N s/mm"),
    ("metrics --cs 1,5", "write 1.5"),
    ("metrics --cs 1.5kN/m", "no unit 'kN/m' of damping rate"),
    ("metrics --cs=-1", "--cs must be >= 0 N s/m"),
    ("metrics --cs 0", "pass cs > 0 at every corner"),
    ("metrics --kt 192", "did you mean 192 N/mm"),
    ("metrics --kt 0", "--kt must be > 0"),
    ("metrics --kt 2.5bar", "no unit 'bar'"),
    ("metrics --ct 1e6", "outside the usual range of tyre damping"),
    ("metrics --mb 1.27", "did you mean 1.27 t"),
    ("metrics --mb 1270t", "did you mean 1270 kg"),
    ("metrics --mb 1270000", "outside the usual range of body mass"),
    ("metrics --mb 1,27", "write 1.27"),
    ("metrics --mb 2800slug", "no unit 'slug'"),
    ("metrics --mb 0", "--mb must be > 0 kg"),
    ("metrics --mu 0.045", "did you mean 0.045 t"),
    ("metrics --mu 45400g", "no unit 'g' of unsprung mass"),
    ("metrics --ixx 0.2", "outside the usual range of roll inertia"),
    ("metrics --iyy 1067kgm", "no unit 'kgm'"),
    ("metrics --a 961", "did you mean 961 mm"),
    ("metrics --a 96.1", "did you mean 96.1 cm"),
    ("metrics --b 1504", "did you mean 1504 mm"),
    ("metrics --c 723", "did you mean 723 mm"),
    ("metrics --c 28.5", "did you mean 28.5 cm"),
    ("metrics --a=-0.9", "--a must be > 0 m"),
    ("metrics --arb-front 20", "did you mean 20 N/mm"),
    ("metrics --arb-rear=-1", "--arb-rear must be >= 0 N/m"),
    ("metrics --arb 1e4", "FullCar has no parameter 'arb'"),
    ("metrics --ms 317", "FullCar has no parameter 'ms'"),
    ("metrics --model quarter --mb 1270", "QuarterCar has no parameter 'mb'"),
    ("metrics --model quarter --ks-front 2e4", "QuarterCar has no parameter 'ks_front'"),
    ("metrics --model pitch-half --ks-left 2e4", "PitchHalfCar has no parameter 'ks_left'"),
    ("metrics --model roll-half --ks-front 2e4", "RollHalfCar has no parameter 'ks_front'"),
    ("metrics --model lorry", "no model named 'lorry', available: full, quarter"),
    ("metrics --model Full", "no model named 'Full'"),
    ("metrics --model half", "no model named 'half'"),
    ("metrics --speed 72", "did you mean 72 km/h"),
    ("metrics --speed 100", "did you mean 100 km/h"),
    ("metrics --speed 72,5km/h", "write 72.5"),
    ("metrics --speed 72kmph", "no unit 'kmph' of speed, available: m/s, km/h, mph"),
    ("metrics --speed 72km", "no unit 'km'"),
    ("metrics --speed 0", "--speed must be > 0 m/s"),
    ("metrics --speed=-20", "--speed must be > 0 m/s"),
    ("metrics --speed fast", "--speed: needs a number"),
    ("metrics --roughness 64", "did you mean 64 cm^3"),
    ("metrics --roughness 16", "did you mean 16 cm^3"),
    ("metrics --roughness 0", "--roughness must be > 0 m^3"),
    ("metrics --roughness B", "--roughness: needs a number"),
    ("metrics --roughness 64e-6m2", "no unit 'm2'"),
    ("metrics --road-class b", "road class must be one of A"),
    ("metrics --road-class I", "road class must be one of A"),
    ("metrics --road-class 3", "road class must be one of A"),
    ("metrics --road-class B --roughness 64e-6", "two ways to say one thing"),
    ("metrics --waviness 2,5", "write 2.5"),
    ("metrics --waviness 4", "--waviness must be > 1 and < 4"),
    ("metrics --waviness two", "--waviness: needs a number"),
    ("metrics --waviness 2m", "--waviness has no unit"),
    ("metrics --waviness 2:5", "--waviness must be > 1 and < 4"),
    ("metrics --knee 0.2", "--knee needs two exponents"),
    ("metrics --waviness 2:1.5 --knee 20cm", "--knee has no unit"),
    ("metrics --contact-length 15", "15 mm"),
    ("metrics --contact-length -0.1", "must be >= 0"),
    ("metrics --spectrum no.csv", "no.csv"),
    ("metrics --weighting Wx", "no weighting named 'Wx', available: Wk"),
    ("metrics --weighting bacc=Wx", "no weighting named 'Wx'"),
    ("metrics --weighting heave=Wk", "no output named 'heave', available: bacc"),
    ("metrics --point driver", "--point must be NAME=X,Y"),
    ("metrics --point driver=a,b", "--point: needs a number"),
    ("metrics --point cg=0,0", "'cg' is a point of FullCar already"),
    ("metrics --model quarter --point driver=0,0", "moves as one point"),
    ("metrics --cutoff 100", "outside the usual range of low-wavenumber cut-off"),
    ("metrics --cutoff=-0.01", "--cutoff must be >= 0 cycle/m"),
    ("metrics --cutoff 0,01", "write 0.01"),
    ("metrics --tracks parallel", "--tracks must be one of identical, independent, isotropic"),
    ("metrics --tracks Isotropic", "--tracks must be one of"),
    ("metrics --wheels front", "no wheel named 'front', available: fr, fl, rr, rl"),
    ("metrics --wheels ,", "at least one wheel"),
    ("metrics --model quarter --wheels fr", "no wheel named 'fr'"),
    ("metrics --method exact", "method must be one of covariance, spectral, time"),
    ("metrics --method spectral --duration 60", "--duration belongs to --method time"),
    ("metrics --method time --duration 0", "duration must be > 0 s"),
    ("metrics --method time --duration 10,5", "write 10.5"),
    ("metrics --method time --duration 1d", "no unit 'd' of time"),
    ("metrics --method time --duration 1ms", "duration must be at least 100 steps"),
    ("metrics --method time --duration 5 --seed=-1", "seed must be a whole number"),
    ("metrics --seed 1", "--seed belongs to --method time"),
    ("metrics --delay yes", "yes"),
    ("metrics --spring 2e4", "--spring"),
    ("metrics 18000", "18000"),
    ("metrics --vehicle missing.toml", "missing.toml: No such file"),
    ("metrics --vehicle .", "Is a directory"),
    ("metric --ks 2e4", "metric"),
    ("bode --from 0", "--from and --to must be 0 < from < to"),
    ("bode --from 0,1", "write 0.1"),
    ("bode --to 0.01", "--from and --to must be"),
    ("bode --from 1rpm", "no unit 'rpm' of frequency"),
    ("bode --from -1", "--from"),
    ("bode --points 1", "--points must be >= 2"),
    ("bode --points ten", "needs a whole number, got 'ten'"),
    ("bode --output bacc", "no output named 'bacc', available: bacc_cg"),
    ("bode --output accel", "no output named 'accel'"),
    ("bode --output ,", "--output names none"),
    ("bode --input z_r", "no input named 'z_r', available: z_r_fr"),
    ("bode --input fr", "no input named 'fr'"),
    ("bode --model quarter --output sws_fr", "available: bacc, sws, dtl"),
    ("bode --ks 24", "did you mean 24 N/mm"),
    ("study --nodes 1", "nodes must be two whole numbers >= 2"),
    ("study --nodes 20x20", "needs a whole number, got '20x20'"),
    ("study --corner front", "no corner named 'front', available: fr, fl, rr, rl"),
    ("study --corner FR", "no corner named 'FR'"),
    ("study --waviness 5", "> 1 and < 4"),
    ("study --speed 72", "did you mean 72 km/h"),
    ("study --ks-range 15000", "--ks-range must be LO:HI"),
    ("study --ks-range 15:30", "did you mean 15 N/mm"),
    ("study --ks-range 15000:30000:20", "--ks-range must be LO:HI"),
    ("study --ks-range 30000:15000", "lowest and highest"),
    ("study --ks-range 15,5e3:3e4", "decimal comma"),
    ("study --cs-range 1:3", "did you mean 1 N s/mm"),
    ("study --cs-range 0:3000", "cs must be two numbers"),
    ("study --low-fidelity missing.toml", "missing.toml: No such file"),
    ("study --low-fidelity full.toml", "low_fidelity must be a car on one wheel"),
    ("study --vehicle quarter.toml", "vehicle must be a car of several wheels"),
    ("study --vehicle car.toml --corner f", "no corner named 'f'"),
    ("study --scan --corner rl", "--corner does not go with --scan"),
    ("study --scan --speed 20", "--speed does not go with --scan"),
    ("study --scan --vehicle car.toml", "--vehicle does not go with --scan"),
    ("study --scan --ks-range 1e4:2e4", "--ks-range does not go with --scan"),
    ("study --ks 2e4", "--ks"),
    ("study --nodes 3 --out full.toml", "full.toml"),
    ("sweep --store o --ks 12:24:10", "did you mean 12 N/mm"),
    ("sweep --store o --ks 12,5e3:24e3:10", "decimal comma; write 12.5e3"),
    ("sweep --store o --ks 12e3-24e3", "needs a number"),
    ("sweep --store o --ks 12e3..24e3", "needs a number"),
    ("sweep --store o --ks 12e3:24e3", "--ks must be LO:HI:N"),
    ("sweep --store o --ks 12e3:24e3:0", "N must be >= 1"),
    ("sweep --store o --ks 12e3:24e3:2.5", "whole number N"),
    ("sweep --store o --ks 24e3:12e3:5", "LO must be below HI"),
    ("sweep --store o --ks 12e3:24e3:5:2", "--ks must be LO:HI:N"),
    ("sweep --store o --ks 12kN/m:24N/cm:5", "no unit 'N/cm'"),
    ("sweep --store o --ks 20000", "nothing to sweep"),
    ("sweep --store o", "nothing to sweep"),
    ("sweep --ks 12e3:24e3:5", "--store"),
    ("sweep --store o --more", "--more"),
    ("sweep --store o --more mu", "--more must be PARAM=LO:HI:N"),
    ("sweep --store o --more mu=40;50;11", "no unit ';50;11' of unsprung mass"),
    ("sweep --store o --more mass=40:50:11", "no parameter 'mass', available: mb"),
    ("sweep --store o --ks 12e3:24e3:5 --more ks=12e3:24e3:5", "ks is given twice"),
    ("sweep --store o --ks-front 12e3:24e3:5 --ks-fr 12e3:24e3:5", "axes ks_front and ks_fr both set ks at fr"),
    ("sweep --store o --vehicle uneven.toml --ks 12e3:24e3:5", "ks would give fr, fl, rr, rl one value"),
    ("sweep --store o --vehicle uneven.toml --ks-left 12e3:24e3:5", "ks_left would give fl, rl one value"),
    ("metrics --vehicle uneven.toml --ks 2e4", "ks would give"),
    ("bode --vehicle uneven.toml --ks-right 2e4", "ks_right would give"),
    ("sweep --store o --ks 12e3:24e3:5 --method time", "method of a sweep must be one of covariance, spectral"),
    ("sweep --store full.toml --ks 12e3:24e3:5", "not a store of a sweep"),
    ("sweep --store o --cs 0:2000:5", "pass cs > 0 at every corner"),
    ("sweep --store o --speed 72 --ks 12e3:24e3:5", "did you mean 72 km/h"),
    ("fit", "--inputs"),
    ("fit --inputs ks --outputs bacc", "RUNS is missing: a table of expensive runs, histories, or --fmu FILE"),
    ("fit missing.csv --inputs ks --outputs bacc", "missing.csv: No such file"),
    ("fit runs.csv --outputs bacc", "--inputs"),
    ("fit runs.csv --inputs ks,cs", "--outputs"),
    ("fit runs.csv --inputs ks,cs --outputs z_acc", "no column 'z_acc', did you mean 'bacc'? available"),
    ("fit runs.csv --inputs Ks,cs --outputs bacc", "did you mean 'ks'"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --units ks", "--units must be NAME=UNIT"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --units ks=kg", "ks is in one of N/m"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --units Feder=N/mm", "no input or output named 'Feder'"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --units ks=N/mm", "the usual range of spring stiffness"),
    (
        "fit runs.csv --inputs ks,cs --outputs bacc --held-out 20",
        "must leave 4 different designs of 16 to fit, got 20",
    ),
    ("fit runs.csv --inputs ks,cs --outputs bacc --held-out=-1", "held_out"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --folds 1", "folds must be a whole number"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --folds all", "needs a whole number, got 'all'"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --surrogate best", "no surrogate of bacc named 'best'"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --at front", "place must be one of"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --tune mass", "no parameter named 'mass'"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --low-fidelity half", "no model named 'half'"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --speed 72", "did you mean 72 km/h"),
    ("fit runs.csv --inputs ks,ks --outputs bacc", "names ks twice"),
    ("fit runs.csv --inputs ks,cs --outputs ks", "ks is asked for as an input and as an output"),
    ("fit runs.csv --inputs =ks,cs --outputs bacc", "NAME or COLUMN=NAME"),
    ("fit kilo.csv --inputs ks,cs --outputs bacc", "did you mean 19 N/mm"),
    ("fit comma.csv --inputs ks,cs --outputs bacc", "column 'ks' has a decimal point: 20000.0"),
    ("fit vague.csv --inputs ks,cs --outputs bacc", "18.500 may be 18.5 or 18500, and no other cell tells"),
    ("fit vague.csv --inputs ks,cs --outputs bacc --decimal point", 'decimal must be "." or ",", got'),
    ("fit utf16.csv --inputs ks,cs --outputs bacc", "not UTF-16 text, as its first bytes say"),
    ("fit latin.csv --inputs ks,cs --outputs bacc", "no column 'ks'"),
    ("fit runs.csv mg.csv --inputs ks,cs --outputs bacc", "RUNS is one table, got 2 files; pass --histories"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --cut 5", "--cut is for --histories and --fmu"),
    ("fit --histories runs.csv --inputs ks,cs --outputs bacc", "--histories needs --cut"),
    ("fit --histories runs.csv --inputs ks,cs --outputs bacc --cut 5", "no column 'time', available"),
    ("fit --histories runs.csv --inputs ks,cs --outputs bacc --cut 5s", "--cut has no unit, got '5s'"),
    (
        "fit --histories runs.csv --inputs ks,cs --outputs bacc --cut 0 --time bacc",
        "the input ks must not change within a run",
    ),
    ("fit runs.csv --inputs ks,cs --outputs bacc --sheet A", "sheet names one of an Excel file's"),
    ("fit hole.csv --inputs ks,cs --outputs bacc", "line 3, column 'cs': cs needs a number, got an empty cell"),
    ("fit words.csv --inputs ks,cs --outputs bacc", "got 'n.a.'"),
    ("fit short.csv --inputs ks,cs --outputs bacc", "line 4: needs 3 cells"),
    ("fit same.csv --inputs ks,cs --outputs bacc", "an input must vary"),
    ("fit few.csv --inputs ks,cs --outputs bacc", "different designs to fit are fewer"),
    ("fit empty.csv --inputs ks,cs --outputs bacc", "no header, the file has no text"),
    ("fit head.csv --inputs ks,cs --outputs bacc", "no runs, only column names"),
    ("fit runs.xlsx --inputs ks,cs --outputs bacc", "not a readable Excel file: File is not a zip file"),
    ("fit runs --inputs ks,cs --outputs bacc", "no suffix"),
    ("fit broken.nc --inputs ks,cs --outputs bacc", "not a readable NetCDF file"),
    ("fit broken.parquet --inputs ks,cs --outputs bacc", "not a readable Parquet file"),
    ("fit mg.csv --inputs ks,cs --outputs bacc", "did you mean 700 mm/s^2"),
    ("predict missing.json --at ks=1", "missing.json: No such file"),
    ("predict runs.csv --at ks=1", "not a surrogate file"),
    ("predict surrogate.json", "one of the two"),
    ("predict surrogate.json --at ks=18", "missing: cs"),
    ("predict surrogate.json --at ks=18,cs=1500,kt=1", "no input named 'kt'"),
    ("predict surrogate.json --at ks=18,cs=1,5", "NAME=VALUE"),
    ("predict surrogate.json --at ks=18kg,cs=1500", "no unit 'kg' of spring stiffness"),
    ("predict surrogate.json --at ks=soft,cs=1500", "--at ks: needs a number"),
    ("predict surrogate.json --at ks=18,ks=19,cs=1", "gives ks twice"),
    ("predict surrogate.json --grid 0", "whole number >= 1"),
    ("predict surrogate.json --grid ks=12:24:0,cs=1500", "N must be >= 1"),
    ("predict surrogate.json --grid ks=12:24,cs=1500", "--grid ks must be LO:HI:N"),
    ("predict surrogate.json --at ks=18,cs=1500 --out runs.csv", "exists already; pass --force"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc", "--range ks=LO:HI is missing"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --range ks=1e4:2e4", "no.fmu: No such file"),
    ("fit --fmu runs.csv --inputs ks --outputs bacc --range ks=1e4:2e4", "runs.csv: no FMU"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --range ks=16:24", "did you mean 16 N/mm"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --range ks", "--range must be NAME=LO:HI"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --range ks=1e4:2e4:3", "--range ks must be LO:HI"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --range ks=1e4:2e4,cs=1e3:2e3", "--range cs: it is none of --inputs"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --range ks=1e4:2e4,ks=1e4:2e4", "--range names ks twice"),
    ("fit --fmu no.fmu runs.csv --inputs ks --outputs bacc", "in place of RUNS; pass one of them"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --heights fr=z,rr", "--heights must be WHEEL=VARIABLE"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --runs ten", "needs a whole number, got 'ten'"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --duration 1d", "no unit 'd' of time"),
    ("fit --fmu no.fmu --inputs ks --outputs bacc --designs plan.csv", "--designs is for --histories"),
    ("fit runs.csv --inputs ks --outputs bacc --weighting Wx", "no weighting named 'Wx', available: Wk"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --runs 30", "--runs is for --fmu"),
    ("fit runs.csv --inputs ks,cs --outputs bacc --kept k.json", "--kept is for --fmu"),
    ("export", "--out"),
    ("export --out car.mo", "car.mo: a vehicle is exported as .fmu or .mat"),
    ("export --out car", "car: a vehicle is exported as .fmu or .mat"),
    ("export --out no/car.fmu", "no/car.fmu: there is no folder no"),
    ("export --out runs.csv", "--out runs.csv exists already; pass --force"),
    ("export --out car.fmu --ks 24", "did you mean 24 N/mm"),
    ("export --out car.fmu --system full.toml", "full.toml: not JSON"),
]

ENTRIES = [
    ('ks = { value = 24, unit = "N/m" }', "ks.value: 24 N/m is outside the usual range of spring stiffness"),
    ('ks = { value = 1520, unit = "t" }', "ks.unit must be one of N/m, N/mm, kN/m, lbf/in, got 't'"),
    ('mb = { value = 1520, unit = "t" }', "did you mean 1520 kg"),
    ('mb = { value = 1,52, unit = "t" }', "a decimal comma? write 1.52"),
    ('mb = { value = "1.52", unit = "t" }', "mb.value must be a number, got '1.52'"),
    ("mb = { value = 1.52 }", "mb.unit must be one of kg, t, lb, got none"),
    ("mb = 1520", "mb must state its unit"),
    ('mb = { value = 1520, unit = "kgs" }', "mb.unit must be one of"),
    ('mb = { value = 1520, units = "kg" }', "no key of mb named 'units', available: value, unit"),
    ('mb = { value = -1520, unit = "kg" }', "mb must be > 0 kg, got -1520"),
    ('mb = { value = nan, unit = "kg" }', "mb must be > 0 kg, got nan"),
    ('mass = { value = 1520, unit = "kg" }', "no parameter of the model 'full' named 'mass'"),
    ('MB = { value = 1520, unit = "kg" }', "named 'MB', available: mb"),
    ('ms = { value = 317, unit = "kg" }', "named 'ms'"),
    ('a = { value = 961, unit = "m" }', "did you mean 961 mm"),
    ('a = { fr = 1.0, unit = "m" }', "no key of a named 'fr'"),
    (
        'ks = { front = 18, rear = 21, unit = "kN/m" }',
        "no key of ks named 'front', available: value, fr, fl, rr",
    ),
    ('ks = { fr = 18, fl = 18, unit = "kN/m" }', "or a value for each of fr, fl, rr, rl"),
    ('ks = { value = 18, fr = 18, unit = "kN/m" }', "ks must have value"),
    ('ks = { fr = 18, fl = 18, rr = 21, rl = 0.021, unit = "kN/m" }', "ks.rl: 0.021 kN/m is outside"),
    ('cs = { value = 1.5, unit = "N s/m" }', "did you mean 1.5 N s/mm"),
    ('cs = { value = 0.5, unit = "kN/m" }', "cs.unit must be one of"),
    ('kt = { value = 192, unit = "N/m" }', "did you mean 192 N/mm"),
    ('kt = { value = [192, 192], unit = "kN/m" }', "kt.value must be a number"),
    ('mu = { value = true, unit = "kg" }', "mu.value must be a number, got True"),
    ('iyy = { value = 1, unit = "t" }', "iyy.unit must be one of kg m^2"),
    ('arb_front = { value = 20, unit = "N/m" }', "did you mean 20 N/mm"),
    ('ks = { value = 18, unit = "kN/m"', "not TOML"),
]
"""Lines of a vehicle file."""

CALLS = [
    (lambda: ss.FullCar(mu=[45.0, 45.0, 40.0, 40.0]), TypeError, "got a list of 4, which may be wheels or designs"),
    (lambda: ss.FullCar(ks=(1e4, 2e4)), ValueError, "Corners(fr=, fl=, rr=, rl=)"),
    (lambda: ss.FullCar(ks="18 kN/m"), TypeError, "got '18 kN/m'; pass a number"),
    (lambda: ss.FullCar(ks=None), TypeError, "got None; pass a number"),
    (lambda: ss.FullCar(1270.0), TypeError, "positional"),
    (lambda: ss.FullCar(m=1270.0), TypeError, "'m'"),
    (lambda: ss.FullCar(cs=ss.Corners(fr=1.0)), TypeError, "missing 3 required keyword-only arguments"),
    (lambda: ss.Corners.axles(1e4, 2e4), TypeError, "positional"),
    (lambda: ss.QuarterCar(ks=ss.Corners.axles(front=1e4, rear=2e4)), TypeError, "takes one value, got Corners"),
    (lambda: ss.QuarterCar(ms=float("nan")), ValueError, "QuarterCar(ms=...) must be > 0 kg, got nan"),
    (lambda: ss.PitchHalfCar(ks=[1e4, 2e4]), TypeError, "(first, second)"),
    (lambda: ss.Road("B"), TypeError, "a class is Road.iso8608('B')"),
    (lambda: ss.Road(speed="72 km/h"), TypeError, "must be > 0 m/s, got '72 km/h'"),
    (lambda: ss.Road(waviness=4.0), ValueError, "> 1 and < 4"),
    (lambda: ss.Road(tracks="left"), ValueError, "one of identical, independent, isotropic"),
    (lambda: ss.Road(wheels="fr"), TypeError, 'a sequence of names such as ("fr",)'),
    (lambda: ss.Road.iso8608("b"), ValueError, "road class must be one of A"),
    (lambda: ss.Road.iso8608("B", roughness=1e-6), ValueError, "pass Road(roughness=...) instead"),
    (lambda: ss.ride_metrics(ct.rss(30, 2, 2), ss.Road()), TypeError, "got a StateSpace"),
    (lambda: ss.ride_metrics(ss.FullCar(), 20.0), TypeError, "road must be a Road"),
    (lambda: ss.ride_metrics(ss.FullCar), TypeError, "road"),
    (lambda: ss.ride_metrics(ss.FullCar, ss.Road()), TypeError, "vehicle must be one of"),
    (lambda: ss.ride_metrics(ss.FullCar(), ss.Road(), method="exact"), ValueError, "covariance, spectral, time"),
    (lambda: ss.ride_metrics(ss.FullCar(cs=0.0), ss.Road()), ValueError, "pass cs > 0 at every corner"),
    (lambda: ss.frequency_response(ss.FullCar(), "1 Hz"), TypeError, "frequency must be numbers in Hz"),
    (lambda: ss.frequency_response(ss.FullCar(), -1.0), ValueError, "frequency"),
    (lambda: ss.Response(ss.FullCar(), ss.Road(), "bacc"), ValueError, "no point named None, available: cg, fr"),
    (
        lambda: ss.Response(ss.FullCar(), ss.Road(), "accel", "fr"),
        ValueError,
        "no criterion named 'accel'",
    ),
    (lambda: ss.Response(ss.FullCar(), ss.Road(), "sws", "front"), ValueError, "no corner named 'front'"),
    (
        lambda: ss.VariableBased(),
        TypeError,
        "VariableBased.__init__() missing 1 required",
    ),
    (
        lambda: ss.ResponseBased(3.0).fit([[1.0], [2.0], [3.0]], [1.0, 2.0, 3.0]),
        TypeError,
        "must be a callable",
    ),
    (lambda: ss.feasibility_study(corner="front"), ValueError, "no corner named 'front', available: fr"),
    (lambda: ss.feasibility_study(nodes=20), TypeError, "nodes must be two whole numbers"),
    (lambda: ss.feasibility_study(ks=15e3), TypeError, "ks must be two numbers"),
    (lambda: ss.feasibility_study(vehicle=ss.QuarterCar()), ValueError, "a car of several wheels"),
    (lambda: ss.feasibility_study(vehicle=ct.rss(2, 1, 1)), TypeError, "got a StateSpace"),
    (lambda: ss.feasibility_study(low_fidelity=ss.FullCar()), ValueError, "a car on one wheel"),
    (
        lambda: ss.feasibility_study(vehicle=ss.FullCar(ks=np.array([1e4, 2e4]))),
        ValueError,
        "one number for every",
    ),
    (lambda: ss.FullCar().replaced(ks_middle=1e4), ValueError, "no parameter 'ks_middle'"),
]

GOOD = "ks,cs,bacc\n" + "".join(f"{18e3 + 700 * i},{1500 - 90 * (i % 5)},{0.7 + 0.01 * i}\n" for i in range(16))

TABLES = {
    "runs.csv": GOOD,
    "runs": GOOD,
    "runs.xlsx": GOOD,
    "broken.nc": GOOD,
    "broken.parquet": GOOD,
    "kilo.csv": "ks,cs,bacc\n18,1500,0.7\n20,1400,0.8\n22,1300,0.9\n17,1350,0.8\n",
    "mg.csv": "ks,cs,bacc\n18e3,1500,700\n20e3,1400,690\n22e3,1300,710\n17e3,1350,700\n",
    "comma.csv": "ks;cs;bacc\n18500,0;1500;0,7\n20000.0;1400;0,8\n",
    "vague.csv": "ks;cs;bacc\n18.500;1.500;1.700\n20.000;1.400;1.800\n",
    "hole.csv": "ks,cs,bacc\n18e3,1500,0.7\n20e3,,0.8\n",
    "words.csv": "ks,cs,bacc\n18e3,1500,0.7\n20e3,1400,n.a.\n",
    "short.csv": "ks,cs,bacc\n18e3,1500,0.7\n20e3,1400,0.8\n22e3,1300\n",
    "same.csv": "ks,cs,bacc\n18e3,1500,0.7\n20e3,1500,0.8\n22e3,1500,0.9\n",
    "few.csv": "\n".join(GOOD.splitlines()[:3]),
    "empty.csv": "",
    "head.csv": "ks,cs,bacc\n",
}


def test_there_are_two_hundred():
    assert len({line for line, _ in COMMANDS}) + len({entry for entry, _ in ENTRIES}) + len(CALLS) >= 200


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    """A folder with the files that the lines name."""
    folder = tmp_path_factory.mktemp("desk")
    for name, text in TABLES.items():
        (folder / name).write_text(text)
    (folder / "utf16.csv").write_bytes(GOOD.encode("utf-16") + b"x")
    (folder / "latin.csv").write_bytes("Weg_in_µm,cs,bacc\n".encode("latin-1"))
    cars = {"full": ss.FullCar(), "car": ss.FullCar(), "quarter": ss.QuarterCar()}
    cars["uneven"] = ss.FullCar(ks=ss.Corners.axles(front=18e3, rear=21e3))
    for name, car in cars.items():
        (folder / f"{name}.toml").write_text(vehicle_text(car))
    X = pd.DataFrame({"ks": [15e3, 20e3, 25e3, 18e3], "cs": [1e3, 2e3, 1.5e3, 1.2e3]})
    model = ss.Polynomial(degree=1).fit(X, [0.010, 0.009, 0.008, 0.0095])
    cheap = ss.LowFidelity(ss.QuarterCar(), ss.Road())
    units = {"ks": "N/m", "cs": "N s/m"}
    SuspensionSurrogate(units, {"sws": "m"}, {"sws": model}, cheap, {}, {"ks": "N/mm"}).save(folder / "surrogate.json")
    return folder


@pytest.mark.parametrize(("line", "said"), COMMANDS, ids=[line for line, _ in COMMANDS])
def test_command(line, said, run, desk, monkeypatch):
    monkeypatch.chdir(desk)
    before = sorted(desk.iterdir())
    code, out, err = run(*line.split())
    assert (code, out) == (2, "")
    assert err.startswith("susp-ss: error: ")
    assert err.count("\n") == 1
    assert said in err
    assert len(err) < 500
    assert "(...," not in err
    assert "=...)" not in err
    assert sorted(desk.iterdir()) == before


@pytest.mark.parametrize(("entry", "said"), ENTRIES, ids=[entry for entry, _ in ENTRIES])
def test_vehicle_file(entry, said, tmp_path):
    path = tmp_path / "car.toml"
    path.write_text(f'model = "full"\n[parameters]\n{entry}\n')
    with pytest.raises(ValueError, match=r"car\.toml: ") as refused:
        read_vehicle(path)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(("call", "kind", "said"), CALLS, ids=range(len(CALLS)))
def test_python(call, kind, said):
    with pytest.raises(kind) as refused:
        call()
    assert said in str(refused.value)
    assert len(str(refused.value)) < 500


def test_predictions_are_in_the_units_of_the_fit(run, desk):
    code, out, _ = run("predict", desk / "surrogate.json", "--at", "ks=18,cs=1500", "--json")
    here, document = ss.load_surrogate(desk / "surrogate.json"), json.loads(out)
    assert code == 0
    assert document["units"] == {"ks": "N/mm", "cs": "N s/m", "sws": "m"}
    (design,) = document["designs"]
    assert design["ks"] == 18.0
    assert design["sws"] == pytest.approx(here.predict({"ks": [18e3], "cs": [1500.0]}).sws[0], rel=1e-12)
    bounds = here.predict({"ks": [18e3], "cs": [1500.0]}, interval=0.95).iloc[0]
    assert (design["sws_low"], design["sws_high"]) == pytest.approx((bounds.sws_low, bounds.sws_high), rel=1e-12)
    assert design["sws_low"] <= design["sws"] <= design["sws_high"]
    stated = run("predict", desk / "surrogate.json", "--at", "ks=18000N/m,cs=1.5Ns/mm", "--json").out
    assert json.loads(stated)["designs"][0]["sws"] == pytest.approx(design["sws"], rel=1e-12)


@pytest.mark.parametrize("line", ["--ks 24N/mm", "--ks 24kN/m", "--ks 24000", "--ks 24000N/m"])
def test_units_are_taken(line, run):
    code, out, _ = run("metrics", *line.split(), "--json")
    assert code == 0
    assert json.loads(out)["metrics"] == json.loads(run("metrics", "--ks", "24e3", "--json").out)["metrics"]


def test_units_are_trusted_if_asked(run, tmp_path):
    assert run("metrics", "--ks", "500", "--trust-units").code == 0
    (tmp_path / "car.toml").write_text('model = "full"\n[parameters]\nks = { value = 500, unit = "N/m" }\n')
    assert run("metrics", "--vehicle", tmp_path / "car.toml", "--trust-units").code == 0
