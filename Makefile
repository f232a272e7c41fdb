# make compare · test · test-whole · test-pages · test-fast · figures · studies · notebooks · lab · bench · bench-check · bench-peers · bbob · reference · docs · dist · check
# Everything runs from .venv, which `make setup` builds once and rebuilds when its inputs change.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
REFERENCE := .venv-reference
PEERS := .venv-peers
DOCS := .venv-docs

# One CPU device per core: runs are sharded over devices, lanes are vectorised within each.
CORES := $(shell $(PYTHON) -c 'import os; print(len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count())')

.DEFAULT_GOAL := help
.PHONY: help setup compare test test-whole test-pages test-fast figures studies notebooks lab bench bench-check bench-peers bbob reference docs dist dist-check
.PHONY: check format clean

help:
	@echo "make compare    the main job: 4 algorithms x 6 scenarios x 20 runs, tables, figures, dataset"
	@echo "make test       the test suite, but for what the next two run"
	@echo "make test-whole whole journeys: plans of every kind, long studies, clusters"
	@echo "make test-pages notebooks, the site's examples, pages in a browser (Chromium, where there is one)"
	@echo "make test-fast  at least one test of every room, for the edit loop"
	@echo "make figures    every table and figure of the paper, and the studies, from data that is kept"
	@echo "make studies    run what these data come from; what is kept already stays (its estimate first)"
	@echo "make notebooks  execute the notebooks and keep their outputs; make lab opens JupyterLab"
	@echo "make bench      timings of the fitness, the optimisers, the whole comparison and the free space"
	@echo "make bench-check AGAINST=main~10  this tree and another one in alternating runs of canaries"
	@echo "make bench-peers  the optimisers beside other libraries' on one fitness (own environment)"
	@echo "make bbob       the optimisers on COCO's 24 functions, beside published ones (environment of reference)"
	@echo "make reference  tests against MuJoCo, pymoo, pyswarms, Drake, COCO (own environment)"
	@echo "make docs       the site, in site/ (own environment); every warning is an error"
	@echo "make dist       sdist and wheel; make dist-check installs the wheel alone and plans with it"
	@echo "make check      lint, format, types, dead code, and the rules of the house"

define new_environment
	@$(PYTHON) -c 'import sys; sys.exit(0 if (3, 11) <= sys.version_info < (3, 14) else "jaxsusp needs Python 3.11 to 3.13, but $(PYTHON) is " + sys.version.split()[0] + "; run: make PYTHON=/path/to/python3.12")'
	rm -rf $(1)
	$(PYTHON) -m venv $(1)
	$(1)/bin/python -m pip install --quiet --constraint constraints.txt --upgrade pip
	$(1)/bin/python -m pip install --quiet --constraint constraints.txt --build-constraint constraints.txt --editable . $(2)
	@touch $(1)/.current
endef

setup: $(VENV)/.current

$(VENV)/.current: pyproject.toml constraints.txt
	$(call new_environment,$(VENV),--group dev)

$(REFERENCE)/.current: pyproject.toml constraints.txt
	$(call new_environment,$(REFERENCE),--group reference)

$(PEERS)/.current: pyproject.toml constraints.txt
	$(call new_environment,$(PEERS),--group peers)

$(DOCS)/.current: pyproject.toml constraints.txt
	$(call new_environment,$(DOCS),--group docs)

compare: setup
	$(BIN)/jaxsusp compare --output results

figures: setup
	$(BIN)/python -m experiments draw

studies: setup
	$(BIN)/python -m experiments make --resume

notebooks: setup
	$(BIN)/python notebooks/execute.py

lab: $(VENV)/.lab
	$(BIN)/jupyter lab notebooks

$(VENV)/.lab: $(VENV)/.current
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --group lab
	@touch $@

test: setup
	$(BIN)/python -m pytest -m "not pages and not whole" --numprocesses $(CORES) --dist loadfile --no-loadscope-reorder

test-whole: setup
	$(BIN)/python -m pytest -m "whole and not pages" --numprocesses $(CORES) --dist loadfile --no-loadscope-reorder

test-pages: setup
	$(BIN)/python -m pytest -m pages --numprocesses $(CORES) --dist loadfile --no-loadscope-reorder

test-fast: setup
	$(BIN)/python -m pytest -m fast --numprocesses $(CORES) --dist loadfile

bench: setup $(REFERENCE)/.current
	JAX_NUM_CPU_DEVICES=$(CORES) $(BIN)/python -m benchmarks
	$(REFERENCE)/bin/python -m benchmarks.regions
	$(BIN)/python -m benchmarks.crowd

# Against a folder or a revision of git; by default what was committed last.
AGAINST ?= HEAD

bench-check: setup
	$(BIN)/python -m benchmarks.check --against $(AGAINST)

bench-peers: $(PEERS)/.current
	$(PEERS)/bin/python -m benchmarks.peers

bbob: $(REFERENCE)/.current
	$(REFERENCE)/bin/python experiments/bbob.py --resume
	MPLBACKEND=agg $(REFERENCE)/bin/python -m cocopp -o results/bbob/pages results/bbob/coco/*

reference: $(REFERENCE)/.current
	$(REFERENCE)/bin/python -m pytest tests/reference

docs: $(DOCS)/.current
	rm -rf site
	$(DOCS)/bin/sphinx-build --fresh-env --fail-on-warning --doctree-dir build/docs/doctrees --quiet docs site
	$(DOCS)/bin/python docs/links.py site

dist: setup
	rm -rf dist
	$(BIN)/python -m hatchling build

dist-check: dist
	$(BIN)/python tests/installed.py dist/*.whl

check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/vulture
	$(BIN)/python -m pytest tests/test_house.py

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:
	rm -rf $(VENV) $(REFERENCE) $(PEERS) $(DOCS) build dist site .pytest_cache .ruff_cache
