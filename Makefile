# `make demo` and `make test` are all that a fresh machine needs; `make help` lists the rest.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
DEMO_ARGS ?=
FUZZ_FACTOR ?= 20
FUZZ_TESTS ?= tests
# Where Node 20 or later is installed, the package that carries one is not needed.
NODE := $(shell sh scripts/gui_npm.sh --has-node && echo || echo ',node')
GUI_NPM := PYTHON=$(abspath $(BIN)/python) sh scripts/gui_npm.sh
PAGE := src/smarttestudo/ruler/server/static/index.html
DOCUMENTATION := src/smarttestudo/ruler/server/documentation/index.html
RELAY := src/smarttestudo/robot/ros/rcl/relay.c src/smarttestudo/robot/ros/rcl/copies.c
GUI_PACKAGES := gui/node_modules/.package-lock.json
GUI_SOURCES := $(shell find gui -type f -not -path 'gui/node_modules/*' -not -path 'gui/tests/*')
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Where it is set, each of hundreds of starts compiles all modules anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help demo gui documentation release test test-all test-plain lint-ci fuzz lint lint-python format docs page-answers test-kilted test-ros test-lowest wheels-aarch64 benchmarks clean test-gui lint-gui docs-site quick coverage

help:
	@echo "make demo            the warehouse mission, with and without adaptive monitoring (no robot needed)"
	@echo "make test            does the house stand: style, types, layers, all tests that start no process with a tenth of"
	@echo "                     each law's examples, a journey through each panel of the page, each promise of the documents"
	@echo "                     on a real ROS graph and a real link. Some five minutes on two cores. It leaves to test-all:"
	@echo "                     all examples of laws, all screens, installations, colcon, the release, documents that run,"
	@echo "                     benchmarks, ROS 2 Kilted, rates, and what the page and live runs do beside these promises"
	@echo "make test-all        everything, as continuous integration runs it: some 35 minutes on two cores"
	@echo "make quick           while working: style, types, layers, and most tests that start no process, in a minute or so"
	@echo "make test-plain      the tests that start no process, with a tenth of each law's examples, for any Python"
	@echo "make fuzz            random examples for every law, $(FUZZ_FACTOR) times as many (FUZZ_FACTOR=, FUZZ_TESTS=)"
	@echo "make coverage        what of the code the tests run, without those on a ROS graph"
	@echo "make gui             the page of 'testudo ruler', from gui/ (needs Node 20, or gets it from PyPI)"
	@echo "make documentation   the documentation that this page opens, from docs/, into the package"
	@echo "make test-gui        the tests of the page's modules and components only"
	@echo "make lint            style, types and layers only, those of the page (make lint-gui) included"
	@echo "make lint-ci         the workflows (actionlint) and the images in docker/ (hadolint)"
	@echo "make format          format the code"
	@echo "make docs            regenerate docs/reference, the page's types and worlds from the code"
	@echo "make page-answers    record anew what the Ruler answers to the tests of the page's components (TESTS=levels)"
	@echo "make docs-site       the documentation as a site in build/site, for any browser, offline"
	@echo "make test-kilted     the live tests on ROS 2 Kilted"
	@echo "make test-ros        the live tests on an installed ROS 2 (ROS_SETUP=/opt/ros/humble/setup.bash)"
	@echo "make test-lowest     the tests with the lowest allowed versions (PYTHON=python3.10)"
	@echo "make wheels-aarch64  show that an ARM robot and laptop install binary wheels only"
	@echo "make release         what a release uploads, tried, into dist/ (TAG=--tag: tagged, too)"
	@echo "make benchmarks      all benchmarks, as root, in three hours; their results are in docs/benchmarks.md"
	@echo "make clean           remove what these commands made"

demo: $(VENV)/studio.stamp
	@$(BIN)/testudo demo $(DEMO_ARGS)

quick: $(VENV)/dev.stamp $(GUI_PACKAGES)
	@TIER=quick $(BIN)/python scripts/run_tests.py

test: $(VENV)/dev.stamp $(PAGE) $(GUI_PACKAGES)
	@TIER=test SWEEPS=some $(BIN)/python scripts/run_tests.py

test-all: $(VENV)/full.stamp $(PAGE) $(DOCUMENTATION) $(GUI_PACKAGES)
	@TIER=all $(BIN)/python scripts/run_tests.py

test-plain: $(VENV)/dev.stamp
	$(BIN)/pytest --numprocesses auto --dist worksteal --tiers plain --examples-factor 0.1 --quiet \
		--ignore tests/robot/ros tests

test-gui: $(VENV)/dev.stamp $(GUI_PACKAGES)
	$(GUI_NPM) test

# What failed is tried first the next time; `make test` tries the same examples each time.
fuzz: $(VENV)/dev.stamp
	$(BIN)/pytest --numprocesses auto --dist worksteal -m hypothesis \
		--hypothesis-profile fuzz --examples-factor $(FUZZ_FACTOR) $(FUZZ_TESTS)

# Live tests run their code in other processes, which are not measured.
coverage: $(VENV)/full.stamp $(PAGE)
	$(BIN)/pytest --numprocesses auto --dist worksteal --ignore tests/ros --ignore tests/ros_package \
		--examples-factor 0.1 --cov --cov-report term:skip-covered --cov-report html tests

gui: $(PAGE)

# Two commands that run beside each other must not both install them.
$(GUI_PACKAGES): gui/package-lock.json | $(VENV)/dev.stamp
	$(GUI_NPM) --version
	@touch $@

$(PAGE): $(GUI_SOURCES) scripts/make_gui.sh scripts/gui_npm.sh | $(VENV)/dev.stamp
	PYTHON=$(abspath $(BIN)/python) sh scripts/make_gui.sh

documentation: $(DOCUMENTATION)

$(DOCUMENTATION): $(shell find docs -type f) $(wildcard *.md) mkdocs.yml scripts/make_documentation.sh scripts/site_hooks.py scripts/site_search.js | $(VENV)/bin/python
	PYTHON=$(abspath $(BIN)/python) sh scripts/make_documentation.sh

lint: lint-python lint-gui lint-ci

lint-python: $(VENV)/dev.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python scripts/release_files.py --check
	$(BIN)/mypy
	$(BIN)/lint-imports

lint-gui: $(VENV)/dev.stamp $(GUI_PACKAGES)
	$(GUI_NPM) run lint

lint-ci: $(VENV)/dev.stamp $(GUI_PACKAGES)
	$(GUI_NPM) run lint:workflows
	$(BIN)/hadolint docker/*.Dockerfile

format: $(VENV)/dev.stamp
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	$(GUI_NPM) run format

page-answers: $(VENV)/dev.stamp $(GUI_PACKAGES)
	PYTHONPATH=tests $(BIN)/python scripts/make_page_answers.py $(TESTS)

docs: $(VENV)/dev.stamp
	$(BIN)/python scripts/make_reference.py
	$(BIN)/python scripts/make_error_texts.py
	$(BIN)/python scripts/make_api_types.py
	$(BIN)/python scripts/make_world.py
	$(BIN)/python scripts/make_map.py
	$(BIN)/python scripts/release_files.py

docs-site: $(VENV)/bin/python
	@PYTHON=$(abspath $(BIN)/python) sh scripts/make_documentation.sh build/site
	@echo "build/site/index.html"

test-kilted: $(VENV)/dev.stamp
	sh scripts/test_kilted.sh live
	sh scripts/test_kilted.sh calm

test-ros: $(VENV)/dev.stamp
	UV=$(abspath $(BIN)/uv) ROS_SETUP=$(ROS_SETUP) bash scripts/test_ros.sh

test-lowest:
	PYTHON=$(PYTHON) sh scripts/test_lowest.sh

wheels-aarch64: $(VENV)/dev.stamp
	UV=$(BIN)/uv sh scripts/wheels_aarch64.sh

release: $(VENV)/full.stamp
	PYTHON=$(BIN)/python sh scripts/release.sh $(TAG)

benchmarks: $(VENV)/full.stamp $(PAGE)
	@failed=; for benchmark in benchmarks/*.py; do \
		echo "$$benchmark"; $(BIN)/python $$benchmark || failed="$$failed $$benchmark"; \
	done; if [ -n "$$failed" ]; then echo "Failed:$$failed" >&2; exit 1; fi

clean:
	rm -rf $(VENV) src/smarttestudo/ruler/server/static src/smarttestudo/ruler/server/documentation src/smarttestudo/ruler/server/documentation.new gui/node_modules tests/link/foxglove/client/node_modules build install log dist htmlcov .coverage .coverage.* demo-out .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	rm -rf src/smarttestudo.egg-info src/smarttestudo/robot/ros/rcl/relay.so
	find src tests workspace_tests benchmarks scripts launch -name __pycache__ -prune -exec rm -rf {} +

$(VENV)/bin/python:
	@PYTHON=$(PYTHON) sh scripts/check_python.sh
	@echo "Making a virtual environment in $(VENV)"
	@$(PYTHON) -m venv $(VENV)

$(VENV)/studio.stamp: pyproject.toml setup.py $(RELAY) | $(VENV)/bin/python
	@echo "Installing SmartTestudo into $(VENV)"
	@$(BIN)/pip install --quiet --editable '.[studio]'
	@touch $@

$(VENV)/dev.stamp: pyproject.toml setup.py $(RELAY) | $(VENV)/bin/python
	@echo "Installing SmartTestudo and its development tools into $(VENV)"
	@$(BIN)/pip install --quiet 'uv>=0.5'
	@$(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python --editable '.[studio,ros-test,dev$(NODE)]'
	@touch $@ $(VENV)/studio.stamp

$(VENV)/full.stamp: $(VENV)/dev.stamp
	@echo "Installing what only 'make test-all' needs into $(VENV)"
	@$(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python --editable '.[full]'
	@touch $@
