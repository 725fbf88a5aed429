# make run    set up, start the page, open the browser      make test   set up, run every test
# make quick  the laws alone, for the inner loop             make check  format, lint, types, layers, every test
# make docs   the documentation, as HTML in build/docs       make bench  side-by-side timings against named peers
# make fuzz   hostile formulas, presets and files            make lowest the laws with the oldest versions that are allowed
#
# Everything is installed into .venv, and again only when pyproject.toml has changed.
# ARGS goes to the program: make run ARGS="--port 9000 --no-browser", make test ARGS="-k hover".
# Another interpreter: make quick PYTHON=python3.13 VENV=.venv-3.13.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Three workers for two cores: one of them drives the browser, and waits for it most of the time.
WORKERS ?= 3
# Each worker computes with one thread: the matrices are small, and workers with several threads each wait for each other.
# Compiled modules are kept, whatever the environment says: the tests start the program some fifty times.
PYTEST := PYTHONDONTWRITEBYTECODE= OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 $(BIN)/python -m pytest --numprocesses $(WORKERS)
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable

.DEFAULT_GOAL := help
.PHONY: help run test quick check lowest docs fuzz format bench clean

help:
	@sed -n '1,8s/^# \{0,1\}//p' Makefile

run: $(VENV)/installed
	@$(BIN)/rangenav-explorer $(ARGS)

test: $(VENV)/installed-test
	$(PYTEST) $(ARGS)

quick: $(VENV)/installed-quick
	$(PYTEST) --ignore tests/browser -m "not slow" $(ARGS)

check: $(VENV)/installed-test
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/pyright --pythonpath $(BIN)/python
	$(BIN)/lint-imports
	$(PYTEST) $(ARGS)

# A second environment with the floor of every direct dependency, made anew when pyproject.toml has changed.
lowest: $(VENV)/installed-test
	@mkdir -p build
	@$(BIN)/python .ci/lowest.py quick studies > build/lowest.txt
	PIP_CONSTRAINT=$(CURDIR)/build/lowest.txt $(MAKE) quick VENV=.venv-lowest

docs: $(VENV)/installed-docs
	$(BIN)/python docs/draw_architecture.py
	$(BIN)/python docs/generate.py
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet $(ARGS) docs build/docs
	@echo "The documentation is in build/docs/index.html."

fuzz: $(VENV)/installed-test
	$(BIN)/python -m tests.fuzz $(ARGS)

format: $(VENV)/installed-test
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: $(VENV)/installed-bench
	$(BIN)/python benchmarks/observer.py
	$(BIN)/python benchmarks/estimators.py
	$(BIN)/python benchmarks/observability.py
	$(BIN)/python benchmarks/rank.py
	$(BIN)/python benchmarks/truth.py
	$(BIN)/python benchmarks/ensemble.py
	$(BIN)/python benchmarks/starts.py
	$(BIN)/python benchmarks/live.py
	$(BIN)/python benchmarks/classroom.py --minutes 2
	$(BIN)/python benchmarks/classroom.py --chromium
	$(BIN)/python benchmarks/start.py
	$(BIN)/python benchmarks/studies.py

clean:
	rm -rf .venv .venv-* build

$(VENV)/created:
	@command -v $(PYTHON) >/dev/null || { echo "$(PYTHON) was not found: install Python 3.11 or newer, or say which one with PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Python 3.11 or newer is needed, but $(PYTHON) is $$($(PYTHON) -V): say which one to use with PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { echo "$(PYTHON) has no venv module: on Debian and Ubuntu, apt install python3-venv." >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/installed: pyproject.toml | $(VENV)/created
	@echo "Installing rangenav into $(VENV) (a minute or two the first time) ..."
	@$(INSTALL) .
	@touch $@

# The extras also hold the project itself, so their stamps stand for the plain one too.
$(VENV)/installed-quick: pyproject.toml | $(VENV)/created
	@echo "Installing rangenav and what its quick tests need into $(VENV) (a minute or two the first time) ..."
	@$(INSTALL) ".[quick]"
	@touch $@ $(VENV)/installed

$(VENV)/installed-test: pyproject.toml | $(VENV)/created
	@echo "Installing rangenav and what its tests need into $(VENV) (a few minutes the first time) ..."
	@$(INSTALL) ".[test]"
	@touch $@ $(VENV)/installed $(VENV)/installed-quick

$(VENV)/installed-docs: pyproject.toml | $(VENV)/created
	@echo "Installing what the documentation is made with into $(VENV) ..."
	@$(INSTALL) ".[docs]"
	@touch $@ $(VENV)/installed

# If the peers cannot all be had, those that can are installed; each benchmark says which one is missing and goes on.
$(VENV)/installed-bench: pyproject.toml | $(VENV)/installed-test
	@echo "Installing the peers that the benchmarks are measured against into $(VENV) ..."
	@$(INSTALL) ".[bench]" || for peer in gtsam pybounds jax; do \
		$(BIN)/python -m pip install --quiet --disable-pip-version-check $$peer || echo "$$peer could not be installed"; \
	done
	@touch $@
