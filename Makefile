# Everything here sets itself up: it needs only CPython 3.11 or later, pip and make.
#   make demo    the paper's beam, from nothing to an HTML report
#   make test    all checks and all tests
#   make help    the rest

VENV := .venv
BIN := $(VENV)/bin
LOCK := requirements-lock.txt
DEMO_OUT := runs/leitz2014
SITE := docs/_build/html

# The first interpreter that is new enough and can make a virtual environment. Give PYTHON=... to choose another.
USABLE := import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))
PYTHON ?= $(shell for p in python3.11 python3 python; do $$p -c '$(USABLE)' >/dev/null 2>&1 && echo $$p && break; done)

# Wheels only: a missing wheel is an error at once. The lock pins every version. Our own C needs a compiler: the system's,
# or that of the package ziglang.
INSTALL := $(BIN)/python -m pip --disable-pip-version-check --no-input install --quiet --only-binary :all:
LOCKED := $(INSTALL) --constraint $(LOCK) --no-build-isolation

unexport PYTHONPATH PYTHONHOME
export MPLBACKEND := Agg

.PHONY: help demo test lint docs docs-links bench audit lock clean

help:
	@echo "make demo    run the paper's beam and write an HTML report to $(DEMO_OUT)"
	@echo "make test    ruff, mypy, import-linter, typos, then pytest"
	@echo "make lint    the checks without the tests"
	@echo "make docs    build the site in docs/_build/html; make docs-links tries its links to the outside"
	@echo "make bench   run every script in benchmarks/, PyElastica from an environment of its own"
	@echo "make audit   measure every rule and write docs/audit.md"
	@echo "make lock    renew $(LOCK) from the ranges in pyproject.toml"
	@echo "make clean   remove the environments, caches and runs"

demo: $(VENV)/.engine
	$(BIN)/cayley run leitz2014 --out $(DEMO_OUT)
	@for report in $(DEMO_OUT)/*.html; do echo "Open the report: $(CURDIR)/$$report"; done

test: lint # two processes on two cores: no threads of BLAS beside them
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n 2

lint: $(VENV)/.dev $(VENV)/.engine
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/typos

# Examples that did not change are not run again; a warning is an error.
docs: $(VENV)/.docs $(VENV)/.engine
	$(BIN)/sphinx-build --fail-on-warning --keep-going --quiet docs $(SITE)
	@echo "Open the documentation: $(CURDIR)/$(SITE)/index.html"

docs-links: $(VENV)/.docs $(VENV)/.engine
	$(BIN)/sphinx-build --quiet --builder linkcheck -D plot_gallery=0 docs docs/_build/links

# The peers live in environments of their own, benchmarks/.venv-peers and .venv-suite, which the scripts make.
BENCHMARKS = limit pyelastica quaternion_matrix wait implicit_cost steel_wire work_precision heavy_top sweep assembly statics contact cosseratbench report

bench: $(VENV)/.dev $(VENV)/.engine
	@set -e; for name in $(BENCHMARKS); do echo "benchmarks/$$name.py"; $(BIN)/python benchmarks/$$name.py; done

audit: $(VENV)/.dev $(VENV)/.engine
	@$(BIN)/python -m audit

NATIVE := $(wildcard src/cayley/steppers/native/*.[ch])

$(VENV)/.run: pyproject.toml $(LOCK)
	@test -n "$(PYTHON)" || { echo "cayley needs CPython 3.11 or later with venv; found none (try PYTHON=/path/to/python3)" >&2; exit 1; }
	@echo "Setting up $(VENV) with $(PYTHON), once; this takes about a minute"
	@$(PYTHON) -m venv --clear $(VENV)
	@$(LOCKED) hatchling editables $(shell command -v cc >/dev/null || echo ziglang)
	@$(LOCKED) --editable .
	@touch $@

# The install compiles the C sources; after they have changed they are compiled again. What is up to date is left alone.
$(VENV)/.engine: $(VENV)/.run hatch_build.py $(NATIVE)
	@$(BIN)/python hatch_build.py
	@touch $@

$(VENV)/.dev: $(VENV)/.run
	@echo "Adding the test and development tools to $(VENV)"
	@$(LOCKED) --editable ".[test,dev]"
	@touch $@

$(VENV)/.docs: $(VENV)/.run
	@echo "Adding the tools of the documentation to $(VENV)"
	@$(LOCKED) --editable ".[docs]"
	@touch $@

lock:
	$(PYTHON) -m venv --clear .venv-lock
	.venv-lock/bin/python -m pip --disable-pip-version-check install --quiet --editable ".[test,dev,docs]" ziglang
	{ grep '^#' $(LOCK); .venv-lock/bin/python -m pip freeze --exclude-editable; } > $(LOCK).new
	mv $(LOCK).new $(LOCK)
	rm -rf .venv-lock

clean:
	rm -rf $(VENV) benchmarks/.venv-peers benchmarks/.venv-suite benchmarks/.suite .venv-lock runs build dist .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis
	rm -rf docs/_build docs/_staged docs/about docs/api docs/gallery docs/sg_execution_times.rst
	find src tests docs -name __pycache__ -type d -prune -exec rm -rf {} +
