# One environment serves every target; it is rebuilt when the project's dependencies change.
PYTHON ?= python3.11
BIN := .venv/bin

# The linear algebra here is many small problems: one thread each beats many threads for one.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: study test test-kernel test-lowest wheel test-wheel docs bench notebooks clean

study: .venv/installed
	$(BIN)/susp-ss study --out results --force

# Tests ask what compiled code computes, not how fast: the quicker compilation will do, kept where no one else takes it.
test test-kernel: export NUMBA_OPT = 0
test test-kernel: export NUMBA_CACHE_DIR = $(CURDIR)/.venv/compiled

test: .venv/installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/pytest

# Rounding differs from one processor's kernel to another's; what the numerical tests find must not.
KERNEL ?= PRESCOTT
FITS := $(addprefix tests/surrogates/test_,correction.py parameter.py polynomial.py radial_basis.py)
NUMERICAL := tests/responses tests/metrics tests/surrogates tests/vehicles

test-kernel: .venv/installed-test
	OPENBLAS_CORETYPE=$(KERNEL) $(BIN)/pytest -m "not slow" tests/responses/covariance $(FITS)

# The numerical tests with every direct dependency at the lower bound of pyproject.toml.
test-lowest:
	test -x .venv-lowest/bin/python || $(PYTHON) -m venv .venv-lowest
	.venv-lowest/bin/python -m pip install --quiet --constraint constraints.txt uv
	.venv-lowest/bin/uv pip install --quiet --python .venv-lowest/bin/python --resolution lowest-direct --editable '.[test]'
	.venv-lowest/bin/pytest -m "not slow" $(NUMERICAL)

wheel: .venv/installed-test
	rm -rf dist
	PIP_CONSTRAINT=$(CURDIR)/constraints.txt $(BIN)/python -m build --outdir dist

test-wheel: wheel
	PIP_CONSTRAINT=$(CURDIR)/constraints.txt $(BIN)/python .ci/try_wheel.py dist/*.whl

# The examples on the pages run as they are built; then the site is opened in a browser.
docs: .venv/installed-docs
	$(BIN)/sphinx-build --fail-on-warning --keep-going --quiet --jobs 6 -d docs/_build/doctrees docs docs/_build/html
	$(BIN)/pytest -n 0 tests/test_docs.py
	@echo open docs/_build/html/index.html

# Runs of the nonlinear car, a quarter of an hour; the same command goes on where one stopped.
NONLINEAR := .venv/nonlinear.csv

$(NONLINEAR): | .venv/installed-test
	$(BIN)/python examples/nonlinear_full_car.py --runs 520 --out $@

bench: .venv/installed-test $(NONLINEAR)
	$(BIN)/python benchmarks/ride_metrics.py
	$(BIN)/python benchmarks/any_road_any_system.py
	$(BIN)/python benchmarks/surrogates.py
	$(BIN)/python benchmarks/design.py
	$(BIN)/python benchmarks/intervals.py $(NONLINEAR)
	$(BIN)/python benchmarks/rare_events.py
	$(BIN)/python benchmarks/feedback.py
	$(BIN)/python benchmarks/next_runs.py $(NONLINEAR)
	$(BIN)/python benchmarks/damaged_files.py
	$(BIN)/python benchmarks/sweeps.py
	$(BIN)/python benchmarks/explorer.py

# Each in one go, for what installs more has installed the less as well. What is never imported need not be compiled.
INSTALL = $(BIN)/python -m pip install --quiet --no-compile --constraint constraints.txt --editable

.venv/installed .venv/installed-test .venv/installed-docs: pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(INSTALL) '.[$(EXTRAS)]'
	touch $(MADE)

.venv/installed: EXTRAS = pages
.venv/installed: MADE = .venv/installed
.venv/installed-test: EXTRAS = test
.venv/installed-test: MADE = .venv/installed .venv/installed-test
.venv/installed-docs: EXTRAS = test,docs
.venv/installed-docs: MADE = .venv/installed .venv/installed-test .venv/installed-docs

# In a container one is root, whom Jupyter would turn away.
notebooks: .venv/installed-notebooks
	$(BIN)/jupyter lab $(if $(filter 0,$(shell id -u)),--allow-root) notebooks

.venv/installed-notebooks: .venv/installed
	$(INSTALL) '.[notebooks]'
	touch $@

clean:
	rm -rf .venv .venv-lowest dist results docs/_build docs/api/generated docs/lessons/*.ipynb
