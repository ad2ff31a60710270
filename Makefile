# make demo             compare three controllers on one scenario
# make test             run the tests, in five minutes; MARKS='not slow': the longer ones, too, as in CI
# make test-slow        run the slow ones, which CI leaves out
# make check            run the linters
# make wheel            build the wheel and the source archive, and try the wheel in an environment of its own
# make bench            run the benchmarks
# make study-crossings  the study of mid-block crossings
# make papers           the papers' claims and figures
# make study-papers     the papers' methods in the same traffic
# make protocols        every controller through the test protocols
# make study-roadside   the effect of a roadside unit where a bus hides pedestrians
# make study-planted    does a screening find the one dangerous crossing? REPLICATIONS=50 of each defect (hours)
# make study-penetration  what becomes of everybody when a share of the cars are egos
# make study-town       a whole town screened: the largest network with crossings of SUMO's games
# make study-validation  the simulation beside real tracks of one junction
# make study-falsify    what breaks the controllers
# make study-solvers    the same drives with four solvers
# make fuzz             files with mistakes: CASES=5000 of them from SEED=1 (a quarter of an hour)
# make chaos            batches that are killed, run out of disk or are damaged: ROUNDS=200 of them from SEED=1
# make zoo              networks that nobody tuned for (hours); SEED=7: other networks; QUICK=1: a few, in minutes
# make golden           every controller in every scenario, briefly, to find out what a code change changed
# make screenshots      the pictures of a report and a replay in docs/images
# make pictures         the pictures of the architecture in docs/images, from the code
# make docs             the documentation as a site: build/site/index.html

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
JOBS ?= 2
MARKS ?=
PIP := $(BIN)/python -m pip --disable-pip-version-check
# Tools are compiled when they are first used: most of their modules never are.
TOOLS := $(PIP) install --quiet --no-compile -c constraints.txt -e

# One BLAS thread: two simulations side by side are otherwise slower than one.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
# Bytecode is kept even where the environment says otherwise: each process would compile what it loads again.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.PHONY: help install demo test test-slow check format wheel bench study-crossings papers study-papers study-roadside study-falsify study-planted study-penetration study-town study-solvers study-validation protocols zoo fuzz chaos golden screenshots pictures docs clean

help:
	@sed -n 's/^# //p' Makefile

# The environment is made afresh whenever its description changes.
$(VENV)/made: pyproject.toml constraints.txt
	rm -rf $(VENV)
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed, this is " + sys.version.split()[0])'
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/installed: $(VENV)/made
	$(PIP) install --quiet -c constraints.txt -e .
	@touch $@

# At once, and so with all that is installed without an extra.
$(VENV)/installed-dev: $(VENV)/made
	$(TOOLS) '.[dev]'
	@touch $(VENV)/installed $@

$(VENV)/installed-papers: $(VENV)/installed
	$(TOOLS) '.[papers]'
	@touch $@

$(VENV)/installed-search: $(VENV)/installed
	$(TOOLS) '.[search]'
	@touch $@

$(VENV)/installed-report: $(VENV)/installed
	$(PIP) install --quiet -c constraints.txt -e '.[report]'
	@touch $@

$(VENV)/installed-docs: $(VENV)/installed
	$(TOOLS) '.[docs]'
	@touch $@

$(VENV)/installed-bench: $(VENV)/installed
	$(TOOLS) '.[bench]'
	@touch $@

$(VENV)/installed-zoo: $(VENV)/installed
	$(TOOLS) '.[zoo]'
	@touch $@

install: $(VENV)/installed

demo: $(VENV)/installed-report
	$(BIN)/python -m cosim.cli.demo

# A file stays in one process, so that what its tests share is made once; the files at the end are short.
test: $(VENV)/installed-dev
	@.ci/browser
	$(BIN)/python -m pytest -q -n $(JOBS) --dist loadfile --no-loadscope-reorder $(if $(MARKS),-m '$(MARKS)')

test-slow: $(VENV)/installed-dev
	$(BIN)/python -m pytest -q -n $(JOBS) --dist worksteal -m slow

check: $(VENV)/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

wheel: $(VENV)/installed-dev
	rm -rf build/dist
	$(BIN)/python -m build --quiet --outdir build/dist
	$(BIN)/twine check --strict build/dist/*
	$(BIN)/python .ci/smoke build/dist/*.whl

format: $(VENV)/installed-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# The other files there are run by hand and say so.
BENCHMARKS := control_step other_methods growth control_over_sumo many_egos judging_everybody memory instructions batch_throughput bars

bench: $(VENV)/installed-bench
	@failed=0; for script in $(BENCHMARKS); do \
	  echo "== $$script"; $(BIN)/python benchmarks/$$script.py || failed=1; \
	done; exit $$failed

study-crossings: $(VENV)/installed
	$(BIN)/cosim batch studies/crossings/crossings.toml --out runs/study-crossings --jobs $(JOBS)
	$(BIN)/python -m studies.crossings.page runs/study-crossings

papers: $(VENV)/installed-papers
	rm -rf runs/papers
	$(BIN)/python -m studies.papers --out runs/papers
	$(BIN)/python -m studies.papers.page runs/papers docs

# The recording is in the wheel of tasi, which is not imported: none of what it requires is needed.
$(VENV)/installed-tracks: $(VENV)/installed
	$(PIP) install --quiet -c constraints.txt -e '.[test,tracks]'
	$(PIP) install --quiet -c constraints.txt --no-deps tasi
	@touch $@

study-validation: $(VENV)/installed-tracks
	mkdir -p runs/study-validation
	rm -rf runs/study-validation/calibration
	$(BIN)/cosim validate braunschweig --tracks tasi --seeds 1-3 --jobs $(JOBS) --out runs/study-validation/all
	$(BIN)/cosim calibrate braunschweig --tracks tasi --split 450 --seeds 1-3 --jobs $(JOBS) --out runs/study-validation/calibration
	$(BIN)/python -m studies.validation.misses > runs/study-validation/misses.md
	$(BIN)/python -m studies.validation.in_place runs/study-validation/in-place $(CARS) > runs/study-validation/in-place.md
	$(BIN)/python -m studies.validation.cost > runs/study-validation/cost.md
	$(BIN)/python -m studies.validation.planted > runs/study-validation/planted.md
	$(BIN)/python -m tests.cosim.tracks.pairs runs/study-validation/all/real > runs/study-validation/pairs.txt
	$(BIN)/python -m studies.validation.page runs/study-validation docs/validation.md

METHODS := studies/methods/midblock_zebra.toml studies/methods/midblock_unmarked.toml \
	studies/methods/jaywalk_arterial.toml studies/methods/bus_stop_occlusion.toml \
	studies/methods/signalised_junction.toml studies/methods/rules_as_printed.toml untuned_network

study-papers: $(VENV)/installed-papers
	$(BIN)/python -m studies.methods runs/study-papers $(METHODS) --jobs $(JOBS)
	$(BIN)/python -m studies.methods.page runs/study-papers docs/study-papers.md

study-roadside: $(VENV)/installed-papers
	$(BIN)/cosim batch studies/roadside/roadside.toml --out runs/study-roadside --jobs $(JOBS)
	$(BIN)/python -m studies.roadside.page runs/study-roadside docs/study-roadside.md

REPLICATIONS ?= 50

study-planted: $(VENV)/installed
	$(BIN)/python -m studies.planted runs/study-planted --replications $(REPLICATIONS) --jobs $(JOBS)
	$(BIN)/python -m studies.planted.page runs/study-planted docs/study-planted.md

study-penetration: $(VENV)/installed-papers
	$(BIN)/cosim batch studies/penetration/penetration.toml --out runs/study-penetration --jobs $(JOBS)
	$(BIN)/python -m studies.penetration.page runs/study-penetration docs/study-penetration.md

study-town: $(VENV)/installed-dev
	$(BIN)/python -m studies.town runs/study-town --jobs $(JOBS) $(TOWN)
	$(BIN)/python -m studies.town.page runs/study-town docs/study-town.md

study-falsify: $(VENV)/installed-search
	$(BIN)/python -m studies.falsify runs/study-falsify docs/study-falsify.md

study-solvers: $(VENV)/installed-bench
	$(BIN)/cosim batch studies/solvers/solvers.toml --out runs/study-solvers/closed-loop --jobs $(JOBS)
	$(BIN)/cosim batch studies/solvers/solvers_paper.toml --out runs/study-solvers/paper --jobs $(JOBS)
	$(BIN)/python -m studies.solvers.page runs/study-solvers

# 1: a controller fails a case, which is what the table is to show.
protocols: $(VENV)/installed-papers
	$(BIN)/python -m studies.protocols all --controller all --out runs/protocols --jobs $(JOBS) || test $$? -eq 1
	$(BIN)/python -m studies.protocols.page runs/protocols docs/protocols.md

# Goes on where it was interrupted. The whole zoo of a seed writes docs/zoo.md, a quick one only its folder.
SEED ?= 1
zoo: $(VENV)/installed-zoo
	$(BIN)/python -m studies.zoo all $(SEED) --jobs $(JOBS) $(if $(QUICK),--quick,--page docs/zoo.md) $(if $(OUT),--out $(OUT))

CASES ?= 5000
fuzz: $(VENV)/installed-dev
	$(BIN)/python -m tests.fuzz --cases $(CASES) --seed $(SEED)

ROUNDS ?= 200

chaos: $(VENV)/installed-dev
	$(BIN)/python -m tests.chaos --rounds $(ROUNDS) --seed $(SEED)

# 3: a run in which SUMO teleports a car is not valid, and compared all the same.
golden: $(VENV)/installed
	rm -rf runs/golden
	$(BIN)/cosim batch studies/golden.toml --out runs/golden --jobs $(JOBS) || test $$? -eq 3
	@echo "compare: $(BIN)/python -m studies.golden runs/golden --against FOLDER_OF_BEFORE"

screenshots: $(VENV)/installed-dev
	rm -rf runs/screenshots
	$(BIN)/cosim batch studies/screenshots.toml --out runs/screenshots --jobs $(JOBS)
	$(BIN)/python -m studies.screenshots runs/screenshots docs/images

pictures: $(VENV)/installed-dev
	$(BIN)/python -m studies.architecture docs/images

# Not --quiet: it keeps warnings from being errors. NO_MKDOCS_2_WARNING: what the theme's makers have to say on every build.
docs: $(VENV)/installed-docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict
	@echo build/site/index.html

clean:
	rm -rf $(VENV) build dist *.egg-info
