# `make demo` and `make test` are all that a fresh machine needs; `make help` lists the rest.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
DEMO_ARGS ?=
PAGE := src/smarttestudo/web/static/index.html
GUI_SOURCES := $(shell find gui -type f -not -path 'gui/node_modules/*') docs/language.md docs/quality-levels.md $(wildcard docs/reference/*.md)
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: help demo gui test lint format docs test-jazzy test-lowest wheels-aarch64 benchmarks clean

help:
	@echo "make demo            the warehouse mission, with and without adaptive monitoring (no robot needed)"
	@echo "make test            everything that must hold: style, types, layers, tests"
	@echo "make gui             the page of 'testudo ruler', from gui/ (needs Node 20, or gets it from PyPI)"
	@echo "make lint            style, types and layers only"
	@echo "make format          format the code"
	@echo "make docs            regenerate docs/reference and worlds from the code"
	@echo "make test-jazzy      the live tests on ROS 2 Jazzy"
	@echo "make test-lowest     the tests with the lowest allowed versions (PYTHON=python3.10)"
	@echo "make wheels-aarch64  show that an ARM robot and laptop install binary wheels only"
	@echo "make benchmarks      all benchmarks; their results are in docs/benchmarks.md"
	@echo "make clean           remove what these commands made"

demo: $(VENV)/studio.stamp
	@$(BIN)/testudo demo $(DEMO_ARGS)

# Live tests go alone: they judge at which rates real messages come.
test: lint $(PAGE)
	$(BIN)/pytest --numprocesses auto --dist loadfile --ignore tests/ros
	$(BIN)/pytest tests/ros

gui: $(PAGE)

$(PAGE): $(GUI_SOURCES) scripts/make_gui.sh | $(VENV)/dev.stamp
	PYTHON=$(abspath $(BIN)/python) sh scripts/make_gui.sh

lint: $(VENV)/dev.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(VENV)/dev.stamp
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: $(VENV)/dev.stamp
	$(BIN)/python scripts/make_reference.py
	$(BIN)/python scripts/make_world.py
	$(BIN)/python scripts/make_map.py

test-jazzy: $(VENV)/dev.stamp
	PYTHON=$(BIN)/python UV=$(BIN)/uv sh scripts/test_jazzy.sh

test-lowest:
	PYTHON=$(PYTHON) sh scripts/test_lowest.sh

wheels-aarch64: $(VENV)/dev.stamp
	UV=$(BIN)/uv sh scripts/wheels_aarch64.sh

benchmarks: $(VENV)/dev.stamp $(PAGE)
	for benchmark in benchmarks/*.py; do $(BIN)/python $$benchmark || exit 1; done

clean:
	rm -rf $(VENV) src/smarttestudo/web/static gui/node_modules build install log dist demo-out .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache

$(VENV)/bin/python:
	@PYTHON=$(PYTHON) sh scripts/check_python.sh
	@echo "Making a virtual environment in $(VENV)"
	@$(PYTHON) -m venv $(VENV)

$(VENV)/studio.stamp: pyproject.toml | $(VENV)/bin/python
	@echo "Installing SmartTestudo into $(VENV)"
	@$(BIN)/pip install --quiet --editable '.[studio]'
	@touch $@

$(VENV)/dev.stamp: pyproject.toml | $(VENV)/bin/python
	@echo "Installing SmartTestudo and its development tools into $(VENV)"
	@$(BIN)/pip install --quiet --editable '.[studio,ros,dev]'
	@touch $@ $(VENV)/studio.stamp
